#include "pipelines/report/style.hpp"

namespace brachium::pipelines::report {

std::string_view style_sheet() {
  return R"css(
:root{color-scheme:light dark;
--ground:#fff;--raised:#f6f7f9;--ink:#1b1f24;--soft:#57606a;--line:#d5dae0;--grid:#e8ebef;--axis:#8a939d;--link:#0550ae;
--good:#1a7f37;--good-bg:#e6f6ea;--warning:#8a5a00;--warning-bg:#fff4d6;--bad:#b3261e;--bad-bg:#fdeaea;
--c0:#0072b2;--c1:#d55e00;--c2:#008a64;--c3:#c0569b;--c4:#a87400;--c5:#3a8fc4;--c6:#4a4f57;--c7:#857a00}
@media screen and (prefers-color-scheme:dark){:root{
--ground:#14171c;--raised:#1d2229;--ink:#e4e8ed;--soft:#a3acb8;--line:#363d47;--grid:#282e37;--axis:#77818e;--link:#7cb7ff;
--good:#5cc97b;--good-bg:#15301f;--warning:#eab54d;--warning-bg:#35290d;--bad:#ff8a80;--bad-bg:#3d1a19;
--c0:#56a8e6;--c1:#ff8b45;--c2:#2cc49a;--c3:#e39bc8;--c4:#f0b429;--c5:#9bd3f5;--c6:#c3c9d1;--c7:#e8de5a}}
*{box-sizing:border-box}
html{scroll-behavior:smooth;-webkit-text-size-adjust:100%}
body{margin:0 auto;max-width:1100px;padding:28px 24px 64px;background:var(--ground);color:var(--ink);
font:15.5px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans","Liberation Sans",Arial,sans-serif}
h1{font-size:28px;line-height:1.2;margin:0 0 4px;letter-spacing:-.01em}
h2{font-size:21px;line-height:1.3;margin:46px 0 10px;padding-top:14px;border-top:1px solid var(--line)}
h3{font-size:17px;margin:26px 0 8px}h4{font-size:15.5px;margin:20px 0 6px}
p{margin:8px 0;max-width:78ch;overflow-wrap:anywhere}
a{color:var(--link);text-underline-offset:2px}a:focus-visible,summary:focus-visible{outline:2px solid var(--link);outline-offset:2px}
code{font:.88em ui-monospace,"Cascadia Mono","DejaVu Sans Mono",Menlo,Consolas,monospace;background:var(--raised);
padding:1px 4px;border-radius:4px;overflow-wrap:anywhere}
.subtitle{color:var(--soft);margin:0}
.verdict{margin:18px 0 0;padding:14px 18px;border-radius:8px;border-left:6px solid var(--axis);background:var(--raised);
font-size:18px;line-height:1.45;max-width:none}
.good.verdict{border-color:var(--good);background:var(--good-bg)}.warning.verdict{border-color:var(--warning);background:var(--warning-bg)}
.bad.verdict{border-color:var(--bad);background:var(--bad-bg)}
.findings{list-style:none;margin:10px 0;padding:0}
.findings li{display:grid;grid-template-columns:88px 1fr;gap:12px;padding:7px 12px;margin:6px 0;border-radius:6px;background:var(--raised);
border-left:4px solid var(--axis);overflow-wrap:anywhere}
.findings li>b{font-weight:600;color:var(--soft)}
.findings .bad{border-color:var(--bad);background:var(--bad-bg)}.findings .bad>b{color:var(--bad)}
.findings .warning{border-color:var(--warning);background:var(--warning-bg)}.findings .warning>b{color:var(--warning)}
.findings .good{border-color:var(--good)}.findings .good>b{color:var(--good)}
.none{color:var(--soft)}
p.good,p.warning,p.bad{padding:8px 14px;border-radius:6px;border-left:4px solid}
p.good{border-color:var(--good);background:var(--good-bg)}p.warning{border-color:var(--warning);background:var(--warning-bg)}
p.bad{border-color:var(--bad);background:var(--bad-bg)}
nav ol{columns:2 260px;column-gap:32px;margin:8px 0;padding-left:24px}nav li{break-inside:avoid;padding:1px 0}
.scroll{overflow-x:auto;margin:12px 0}
table{border-collapse:collapse;font-size:14px;line-height:1.4;font-variant-numeric:tabular-nums}
caption{text-align:left;font-weight:600;padding:0 0 6px;font-size:14.5px}
th,td{padding:5px 12px;text-align:left;vertical-align:top;border-bottom:1px solid var(--grid)}
thead th{font-weight:600;color:var(--soft);border-bottom:2px solid var(--line);vertical-align:bottom}
tbody th{font-weight:500}
tbody tr:hover{background:var(--raised)}
td code,th code{white-space:nowrap}
.w{min-width:10.5em}
td:not(.w),tbody th:not(.w){white-space:nowrap}
.n{text-align:right;white-space:nowrap}
td.good,th.good{color:var(--good)}td.warning,tbody th.warning{color:var(--warning);background:var(--warning-bg);font-weight:600}
td.bad,tbody th.bad{color:var(--bad);background:var(--bad-bg);font-weight:700}
.prov tbody th{width:1%;white-space:nowrap;color:var(--soft)}.prov tbody td{white-space:normal;overflow-wrap:anywhere}
.row{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,var(--w)),1fr));gap:18px 26px;margin:14px 0;align-items:start}
.rowlegend{grid-column:1/-1;margin-bottom:-12px}
figure{margin:0;min-width:0}
figcaption{font-weight:600;font-size:14.5px;margin:0 0 2px}
.legend{list-style:none;display:flex;flex-wrap:wrap;gap:2px 18px;margin:0 0 4px;padding:0;font-size:12.5px;line-height:1.5;color:var(--ink)}
.legend li{display:flex;align-items:center;gap:6px}
.note{font-size:13px;line-height:1.45;color:var(--soft);margin:4px 0 0}
svg.plot{display:block;width:100%;max-width:100%;overflow:visible}
svg.plot text{font-size:11px;fill:var(--soft);font-variant-numeric:tabular-nums}
svg.plot text.yl,svg.plot text.xl{font-size:11.5px}
svg.plot text.ml{font-size:10.5px}
svg.plot text.good{fill:var(--good)}svg.plot text.warning{fill:var(--warning)}svg.plot text.bad{fill:var(--bad)}
.panel *,.k *{vector-effect:non-scaling-stroke}
.ground{fill:none;pointer-events:all}
.grid{stroke:var(--grid);fill:none}.zero{stroke:var(--axis);fill:none;stroke-width:.8}.frame{stroke:var(--axis);fill:none;stroke-width:1.6}
.l{fill:none;stroke-width:1.5;stroke-linejoin:round;stroke-linecap:round}.l.dense{stroke-width:1.1;stroke-opacity:.85}
.d{stroke-dasharray:7 4;stroke-linecap:butt}.r{stroke-dasharray:2 3}
.p{fill:none;stroke-width:4;stroke-linecap:round;stroke-opacity:.6}.p.many{stroke-width:2.6}.a{fill-opacity:.75}.b{fill-opacity:.25}.a,.b{stroke-width:.6}
.c0{stroke:var(--c0)}.c1{stroke:var(--c1)}.c2{stroke:var(--c2)}.c3{stroke:var(--c3)}.c4{stroke:var(--c4)}.c5{stroke:var(--c5)}.c6{stroke:var(--c6)}.c7{stroke:var(--c7)}
.c0.a,.c0.b{fill:var(--c0)}.c1.a,.c1.b{fill:var(--c1)}.c2.a,.c2.b{fill:var(--c2)}.c3.a,.c3.b{fill:var(--c3)}
.c4.a,.c4.b{fill:var(--c4)}.c5.a,.c5.b{fill:var(--c5)}.c6.a,.c6.b{fill:var(--c6)}.c7.a,.c7.b{fill:var(--c7)}
.mark{fill:none;stroke:var(--soft);stroke-width:1.2;stroke-dasharray:4 3}
.mark.good{stroke:var(--good)}.mark.warning{stroke:var(--warning)}.mark.bad{stroke:var(--bad)}
.span{fill:var(--axis);fill-opacity:.16;stroke:none}
.span.good{fill:var(--good)}.span.warning{fill:var(--warning)}.span.bad{fill:var(--bad)}
svg.chain{display:block;margin:0 auto;max-width:100%;height:auto;min-width:var(--w)}
.box rect{fill:var(--raised);stroke:var(--axis);stroke-width:1.3}
.box.good rect{stroke:var(--good)}.box.warning rect{stroke:var(--warning);fill:var(--warning-bg)}
.box.bad rect{stroke:var(--bad);fill:var(--bad-bg);stroke-width:2.4}.box.input rect{fill:var(--ground);stroke-dasharray:4 3}
.box.dim rect{stroke-dasharray:2 3}.box.dim text{opacity:.75}
.box .name{font-size:14px;font-weight:600;fill:var(--ink)}.box .run{font-size:12px;fill:var(--soft)}.box .status{font-size:12px;fill:var(--ink)}
.box.good .status{fill:var(--good)}.box.bad .status{fill:var(--bad)}.box.warning .status{fill:var(--warning)}
.edge{fill:none;stroke:var(--axis);stroke-width:1.4}.head{fill:var(--axis)}
.view3d{margin:14px 0}
svg.poster{display:block;width:100%;height:auto;background:var(--raised);border-radius:8px}
svg.poster text{font-size:12px;fill:var(--ink);font-variant-numeric:tabular-nums}
.body path{fill:currentColor;stroke:currentColor;stroke-width:.7;stroke-linejoin:round}.body path.e{fill:none;stroke:#000;stroke-opacity:.34;stroke-width:.6}
.ruler{fill:none;stroke:var(--ink);stroke-width:1.4}
.v3bar{display:none}.v3stage{display:none}.live>.v3bar{display:flex}.live>.v3stage{display:block}.live>svg.poster{display:none}
.v3bar{flex-wrap:wrap;align-items:center;gap:6px 16px;font-size:13.5px;margin:8px 0}
.v3bar label{display:inline-flex;align-items:center;gap:5px;white-space:nowrap}
.v3bar select,.v3bar button{font:inherit;color:var(--ink);background:var(--raised);border:1px solid var(--line);border-radius:6px;padding:3px 9px}
.v3bar button{cursor:pointer;min-width:34px}.v3bar input{accent-color:var(--c0)}.v3bar input[type=range]{flex:0 1 220px;min-width:120px}
.v3bar :focus-visible,.v3stage canvas:focus-visible{outline:2px solid var(--link);outline-offset:1px}
.v3checks{display:flex;flex-wrap:wrap;align-items:center;gap:4px 14px;margin-left:auto}.v3state{font-variant-numeric:tabular-nums;white-space:pre}
.v3legend{position:relative;flex:1 1 220px;max-width:380px;height:30px;margin:0 16px}.v3strip{height:10px;border-radius:2px}
.v3legend span{position:absolute;top:13px;transform:translateX(-50%);font-size:11.5px;line-height:1.3;color:var(--soft);font-variant-numeric:tabular-nums}
.v3stage{position:relative;height:clamp(260px,46vw,500px);background:var(--raised);border-radius:8px;overflow:hidden}
.v3stage canvas{position:absolute;inset:0;width:100%;height:100%;border-radius:8px;touch-action:none;cursor:grab}.v3stage canvas:active{cursor:grabbing}
.v3stage .v3over{pointer-events:none}
.v3tip{position:absolute;display:none;pointer-events:none;background:var(--ink);color:var(--ground);font-size:12px;line-height:1.4;padding:2px 7px;border-radius:4px;white-space:nowrap}
details{margin:12px 0;border:1px solid var(--line);border-radius:8px;padding:0 16px}
summary{cursor:pointer;padding:9px 0;font-weight:600}details[open]{padding-bottom:12px}
.more{border:0;padding:0;margin:4px 0 0;font-size:13.5px}.more summary{padding:2px 0;font-weight:400;color:var(--soft)}
.findings .more ul{margin:2px 0 4px;padding-left:20px}.findings .more li{display:list-item;padding:0;margin:1px 0;background:none;border:0}
.methods p{hyphens:auto}
.hidden{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%);white-space:nowrap}
#probe{position:fixed;z-index:2;pointer-events:none;background:var(--ink);color:var(--ground);font-size:12px;line-height:1.4;
padding:2px 7px;border-radius:4px;font-variant-numeric:tabular-nums;display:none}
@media(max-width:600px){body{padding:18px 14px 48px;font-size:15px}h1{font-size:23px}h2{font-size:19px}.verdict{font-size:16px;padding:12px 14px}
.findings li{grid-template-columns:1fr;gap:0}th,td{padding:4px 8px}.prov tbody th{white-space:normal}}
@media print{@page{margin:15mm 14mm}
body{max-width:none;padding:0;font-size:10.5pt;-webkit-print-color-adjust:exact;print-color-adjust:exact}
h1{font-size:19pt}h2{font-size:14pt;margin-top:22pt}h3{font-size:12pt}
h2,h3,h4,summary,figcaption,caption,.rowlegend{break-after:avoid}figure,tr,.findings li,.verdict,svg.chain,svg.poster{break-inside:avoid}
thead{display:table-header-group}table{font-size:9pt}th,td{padding:3pt 6pt}.scroll{overflow:visible}
.row{grid-template-columns:repeat(auto-fill,minmax(min(100%,calc(var(--w)*.68)),1fr))}
svg.chain{min-width:0;max-height:135mm;width:auto}
details{border:0;padding:0}details::details-content{content-visibility:visible;display:block}
.live>.v3bar,.live>.v3stage,.v3help{display:none}.live>svg.poster{display:block}
a{color:inherit}nav a{text-decoration:none}#probe,.fold{display:none!important}
.l.c1:not(.d){stroke-dasharray:9 3}.l.c2:not(.d){stroke-dasharray:2 2}.l.c3:not(.d){stroke-dasharray:9 3 2 3}
.l.c4:not(.d){stroke-dasharray:5 2}.l.c5:not(.d){stroke-dasharray:12 3 2 3 2 3}.l.c6:not(.d){stroke-dasharray:1 3}.l.c7:not(.d){stroke-dasharray:14 4}}
)css";
}

std::string_view page_script() {
  return R"js(
(function(){
var d=document,folds=[].slice.call(d.querySelectorAll('details')),shut=[];
addEventListener('beforeprint',function(){shut=folds.filter(function(f){return!f.open});shut.forEach(function(f){f.open=true})});
addEventListener('afterprint',function(){shut.forEach(function(f){f.open=false})});
function reveal(){var t=location.hash&&d.getElementById(decodeURIComponent(location.hash.slice(1)));
for(var p=t;p;p=p.parentElement)if(p.tagName==='DETAILS')p.open=true;if(t)t.scrollIntoView()}
addEventListener('hashchange',reveal);reveal();
var probe=d.createElement('div');probe.id='probe';d.body.appendChild(probe);
function value(a,u){a=a.split(' ').map(Number);return a[2]?a[0]*Math.pow(a[1]/a[0],u):a[0]+u*(a[1]-a[0])}
[].forEach.call(d.querySelectorAll('svg.panel'),function(s){
s.addEventListener('mousemove',function(e){var r=s.querySelector('.ground').getBoundingClientRect();
var u=(e.clientX-r.left)/r.width,v=1-(e.clientY-r.top)/r.height;
probe.textContent=value(s.dataset.x,u).toPrecision(4)+' , '+value(s.dataset.y,v).toPrecision(4);
probe.style.display='block';probe.style.left=Math.min(e.clientX+14,innerWidth-130)+'px';probe.style.top=(e.clientY+14)+'px'});
s.addEventListener('mouseleave',function(){probe.style.display='none'})});
})();
)js";
}

}  // namespace brachium::pipelines::report
