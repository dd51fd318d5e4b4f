// How the page of a sweep looks, and the script that links its points, rows and pictures.
#pragma once

#include <string_view>

namespace frustum {

inline constexpr std::string_view page_style = R"css(
:root{color-scheme:light dark;--ground:#f7f7f5;--surface:#fff;--sunken:#f1f1ee;--ink:#1b1e22;
--soft:#5f666f;--faint:#8c929b;--line:#e3e3df;--grid:#ececea;--accent:#22698a;
--c0:#1f77a8;--c1:#d9722b;--c2:#3a9a5b;--c3:#b8475b;--c4:#7b5bb5;--c5:#8a6d4a;--c6:#c45aa6;--c7:#5d6c7b;
--c8:#a89a1c;--c9:#1fa3a3;
--shadow:0 1px 2px rgb(20 25 30/5%),0 6px 20px rgb(20 25 30/4%);
--text:system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue","Noto Sans",sans-serif;
--mono:ui-monospace,"SF Mono",Menlo,Consolas,"DejaVu Sans Mono",monospace}
@media(prefers-color-scheme:dark){:root{--ground:#111316;--surface:#181b1f;--sunken:#131619;--ink:#e7e9ec;
--soft:#a2a9b2;--faint:#757c86;--line:#2a2e34;--grid:#24282d;--accent:#7fc4e2;
--c0:#5cb3e0;--c1:#f0975a;--c2:#67c587;--c3:#e77b8c;--c4:#a98ae0;--c5:#c3a27a;--c6:#e58cc9;--c7:#9fb0c0;
--c8:#d6c84a;--c9:#56cfcf;--shadow:0 1px 2px rgb(0 0 0/30%)}}
*{box-sizing:border-box}body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 var(--text);
font-variant-numeric:tabular-nums}
main{max-width:1180px;margin:0 auto;padding:2.5rem 1.5rem 5rem;display:grid;gap:2.75rem}main>*{min-width:0}
h1,h2,h3,p{margin:0;text-wrap:pretty}h1{font-size:1.8rem;line-height:1.2;font-weight:650;
letter-spacing:-.015em}h2{font-size:1.15rem;font-weight:620;margin-bottom:.35rem}
h3{font-size:.92rem;font-weight:620;overflow-wrap:anywhere}code{font-family:var(--mono);font-size:.86em}
.soft{color:var(--soft)}.small{font-size:.84rem}
.where{color:var(--soft);font-size:.88rem;margin-top:.35rem;overflow-wrap:anywhere}
.answer{font-size:1.12rem;line-height:1.55;margin-top:1.2rem;max-width:62rem}.answer b{font-weight:650}
.card{background:var(--surface);border:1px solid var(--line);border-radius:12px;box-shadow:var(--shadow);
padding:1.1rem 1.2rem}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(9.5rem,1fr));gap:1px;margin-top:1.4rem;
background:var(--line);border:1px solid var(--line);border-radius:10px;overflow:hidden}
.tiles>div{background:var(--surface);padding:.8rem 1rem}.tiles .value{font-size:1.25rem;font-weight:600;
letter-spacing:-.015em}.tiles .label{color:var(--soft);font-size:.8rem}
.stage{display:grid;grid-template-columns:minmax(0,1fr) 292px;gap:1.2rem;align-items:start}
@media(max-width:900px){.stage{grid-template-columns:1fr}}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;font-size:.84rem;color:var(--soft);margin:.5rem 0 0}
.legend i{display:inline-block;width:.7rem;height:.7rem;border-radius:50%;margin-right:.4rem;
vertical-align:-1px}
.legend i.step{width:1.2rem;height:0;border-radius:0;border-top:3px solid var(--accent);
vertical-align:4px;opacity:.55}
.look{position:sticky;top:1rem}.look img{width:100%;display:block;border-radius:6px;background:#000;
image-rendering:auto}.look figure{margin:0 0 .7rem}.look figcaption{font-size:.8rem;color:var(--soft);
margin-top:.25rem}.look dl{display:grid;grid-template-columns:auto 1fr;gap:.1rem .8rem;margin:.2rem 0 0;
font-size:.86rem}.look dt{color:var(--soft)}.look dd{margin:0;text-align:right}
.plot{width:100%;height:auto;display:block;overflow:visible}.plot text{font-family:var(--text)}
.plot .tick{font-size:11.5px;fill:var(--soft)}.plot .label{font-size:12px;fill:var(--soft)}
.plot .grid{stroke:var(--line);stroke-width:1}.plot .thin{stroke:var(--grid)}
.plot .axis{stroke:var(--faint)}.plot .join{fill:none;stroke:currentColor;stroke-width:1.6;opacity:.45}
.plot .front{fill:none;stroke:var(--accent);stroke-width:7;stroke-linejoin:round;opacity:.2}
.plot .dot{fill:currentColor;stroke:var(--surface);stroke-width:1.2;cursor:pointer}
.plot .ring{stroke:var(--ink);stroke-width:2}
.plot .exact{fill:var(--surface);stroke:currentColor;stroke-width:1.6}
.plot .dot:hover,.plot .dot.on{stroke:var(--ink);stroke-width:2.4}.plot .fit{stroke:currentColor;
stroke-width:1.6;opacity:.9}.plot .theory{stroke:var(--faint);stroke-width:1.6;stroke-dasharray:5 4}
.s0{color:var(--c0)}.s1{color:var(--c1)}.s2{color:var(--c2)}.s3{color:var(--c3)}.s4{color:var(--c4)}
.s5{color:var(--c5)}.s6{color:var(--c6)}.s7{color:var(--c7)}.s8{color:var(--c8)}.s9{color:var(--c9)}
.knobs{display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:1rem;margin-top:.9rem}
.knobs .card{padding:.95rem 1rem .7rem}.knobs p{font-size:.83rem;color:var(--soft);margin-top:.15rem}
.slopes{display:flex;gap:.15rem 1.1rem;margin:.35rem 0 .3rem;font-size:.85rem;color:var(--soft);flex-wrap:wrap}
.slopes b{color:var(--ink);font-weight:620}.good{color:var(--c2)!important}.off{color:var(--c1)!important}
table{border-collapse:collapse;width:100%;font-size:.87rem}th{text-align:right;font-weight:560;
color:var(--soft);padding:.35rem .6rem;border-bottom:1px solid var(--line);white-space:nowrap}
td{text-align:right;padding:.32rem .6rem;border-bottom:1px solid var(--grid);white-space:nowrap}
th:first-child,td:first-child{text-align:left;white-space:normal}
tbody tr:hover,tr.on{background:var(--sunken)}tr[data-point]{cursor:pointer}.scroll{overflow-x:auto}
.bar{display:inline-block;height:.55rem;border-radius:3px;background:currentColor;opacity:.75;
vertical-align:1px}
.wall{display:grid;grid-template-columns:repeat(auto-fill,minmax(210px,1fr));gap:.9rem;margin-top:.9rem}
.wall figure{margin:0;background:var(--surface);border:1px solid var(--line);border-radius:9px;
overflow:hidden}.wall .pair{display:grid;grid-template-columns:1fr 1fr;gap:1px;background:var(--line)}
.wall img{width:100%;display:block;background:#000}.wall figcaption{padding:.45rem .65rem .5rem;
font-size:.8rem;line-height:1.4;overflow-wrap:anywhere}
.wall .front{border-color:var(--accent)}ul{margin:.3rem 0 0;padding-left:1.1rem}li{margin:.15rem 0}
@media print{.look{position:static}}
)css";

inline constexpr std::string_view page_script = R"js(
"use strict";
const looks=JSON.parse(document.getElementById("points").textContent),look=document.getElementById("look");
function show(i){if(!look)return;document.querySelectorAll(".on").forEach(e=>e.classList.remove("on"));
document.querySelectorAll('[data-point="'+i+'"]').forEach(e=>e.classList.add("on"));
const f=document.getElementById("figure"+i),p=looks[i];look.querySelector("h3").textContent=p.name;
const dl=look.querySelector("dl");dl.textContent="";
for(const [k,v] of p.facts){const a=document.createElement("dt"),b=document.createElement("dd");
a.textContent=k;b.textContent=v;dl.append(a,b)}
if(f){const s=f.querySelectorAll("img"),t=look.querySelectorAll("img");
t.forEach((e,k)=>{if(s[k])e.src=s[k].src})}}
document.querySelectorAll("[data-point]").forEach(e=>{const i=e.dataset.point;
e.addEventListener("mouseenter",()=>show(i));e.addEventListener("click",()=>show(i))});
)js";

}  // namespace frustum
