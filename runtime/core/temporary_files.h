// The names of files that are not finished, so that a process which is ended at once leaves none behind.
#pragma once

#include <string>

namespace frustum {

// From now on, until it is forgotten, remove_temporary_files() removes the file of that name, if there is
// one. Any thread. Remember before making the file, forget after removing or renaming it.
void remember_temporary_file(const std::string& path);
void forget_temporary_file(const std::string& path);

// Removes them all. Async-signal-safe: takes no lock and no memory. A file that another thread makes during
// the call may stay.
void remove_temporary_files() noexcept;

// A module that was loaded with a copy of this library remembers files of its own: those too, from now on.
using RemoveTemporaryFiles = void (*)() noexcept;
void include_temporary_files(RemoveTemporaryFiles of_module);

}  // namespace frustum
