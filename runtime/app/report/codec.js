// Numbers out of the page: base64, inflated, byte planes joined. runtime/app/report/blobs.cpp is the other half.

const arrays = {f32: Float32Array, f64: Float64Array, u32: Uint32Array};
const decoded = new Map();

// {"blob", "kind", "count"} as a typed array; decoded once.
export function numbers(blob) {
  if (!decoded.has(blob.blob)) decoded.set(blob.blob, decode(blob));
  return decoded.get(blob.blob);
}

async function decode({blob, kind, count}) {
  const text = atob(document.getElementById(`blob-${blob}`).textContent);
  const deflated = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const array = arrays[kind], width = array.BYTES_PER_ELEMENT;
  const joined = new Uint8Array(count * width);
  for (let b = 0; b < width; ++b)
    for (let i = 0, from = b * count; i < count; ++i) joined[i * width + b] = planes[from + i];
  return new array(joined.buffer);
}
