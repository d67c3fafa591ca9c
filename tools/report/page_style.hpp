// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>

namespace palpate::report {

/// The report's style sheet: light and dark by the reader's choice, light on paper.
inline constexpr std::string_view page_style = R"css(
:root{color-scheme:light dark;--paper:#fff;--ground:#eef1f4;--ink:#17212b;--soft:#5b6875;--line:#d9dfe5;
--accent:#1f6f8b;--wash:#e4f0f4;--good:#1d7a46;--good-wash:#e3f4ea;--bad:#b3261e;--bad-wash:#fce8e6}
@media screen and (prefers-color-scheme:dark){:root{--paper:#18212a;--ground:#10161c;--ink:#e6ebf0;--soft:#9aa8b5;
--line:#2d3945;--accent:#5fb4d0;--wash:#1d3340;--good:#6cd39a;--good-wash:#173326;--bad:#ff9a92;--bad-wash:#43201e}}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI","DejaVu Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:32px 20px 60px}
header,section{background:var(--paper);border:1px solid var(--line);border-radius:10px;padding:24px 28px;margin:0 0 18px}
.kind{margin:0;color:var(--soft);font-size:13px;letter-spacing:.08em;text-transform:uppercase}
h1{margin:2px 0 14px;font-size:34px;line-height:1.15;letter-spacing:-.01em}
h2{margin:0 0 4px;font-size:21px}
h3{margin:22px 0 8px;font-size:16px}
.lead{margin:0 0 16px;color:var(--soft);max-width:78ch}
.verdict{display:flex;gap:14px;align-items:flex-start;border-radius:8px;padding:12px 16px;margin:0 0 18px;background:var(--good-wash)}
.verdict strong{color:var(--good);font-size:17px;white-space:nowrap}
.cautions{border:1px solid var(--line);border-radius:8px;padding:10px 16px;margin:0 0 18px;font-size:14px}.cautions ul{margin:4px 0 0;padding-left:20px}
.verdict.failed{background:var(--bad-wash)}.verdict.failed strong{color:var(--bad)}
.cards{display:flex;flex-wrap:wrap;gap:10px;margin:0}
.cards div{flex:1 1 135px;border:1px solid var(--line);border-radius:8px;padding:9px 12px}
.cards dt{color:var(--soft);font-size:12.5px}
.cards dd{margin:0;font-size:20px;font-weight:600;font-variant-numeric:tabular-nums;white-space:nowrap}
.cards dd small{font-size:13px;font-weight:400;color:var(--soft)}
nav{margin:0 0 18px;font-size:14px}nav a{color:var(--accent);text-decoration:none;margin-right:18px}nav a:hover{text-decoration:underline}
.two,.three{display:grid;gap:16px;margin:0 0 12px}
.two{grid-template-columns:repeat(auto-fit,minmax(330px,1fr))}
.three{grid-template-columns:repeat(auto-fit,minmax(280px,1fr))}
figure{margin:0}figure img,figure svg{display:block;width:100%;height:auto;border-radius:8px}
figure img{border:1px solid var(--line)}
figcaption{margin-top:6px;color:var(--soft);font-size:13.5px}
.chart img{background:#fff;padding:8px}.chart+figcaption{margin-bottom:14px}.missing+.missing{margin-top:10px}
.slice{background:#000}
.slice text{fill:#ffe9a8;font-size:20px;font-weight:600;paint-order:stroke;stroke:#000;stroke-width:4px}
.slice .small{font-size:16px;font-weight:400}
.slice .scale{stroke:#ffe9a8;stroke-width:4;fill:none}
.slice .outline{stroke:#fff;stroke-width:1.3;stroke-dasharray:4 3;fill:none;opacity:.9}
.view{background:#f6f8fa;border:1px solid var(--line)}
.view text{fill:#17212b;font-size:19px;font-weight:600;paint-order:stroke;stroke:#fff;stroke-width:4px}
.view path{stroke:#17212b;stroke-width:2.5;fill:none}
.view circle{fill:none;stroke:#b3261e;stroke-width:3}.view .mark{fill:#b3261e;font-size:21px}
.tetrahedron{background:#f6f8fa;border:1px solid var(--line)}
.tetrahedron path{fill-opacity:.45}.edge{stroke:#17212b;stroke-width:1.6;fill:none}.hidden{stroke-dasharray:5 4;stroke-width:1.2}
.angle{fill:#17212b;font-size:15px;paint-order:stroke;stroke:#fff;stroke-width:4px}.angle.worst{fill:#b3261e;font-weight:700}
figure .scale-bar{max-width:420px;margin:8px 0 2px}.scale-bar .tick{font-size:13px}
.legend{list-style:none;display:flex;flex-wrap:wrap;gap:4px 20px;margin:4px 0 14px;padding:0;font-size:14px}
.swatch{display:inline-block;width:.85em;height:.85em;border-radius:3px;margin-right:.45em;vertical-align:-.06em;border:1px solid rgb(0 0 0/.25)}
.dot{display:inline-block;width:.6em;height:.6em;border-radius:50%;background:#1a2942;margin-right:.5em;border:1px solid var(--soft)}
.dash{display:inline-block;width:1.6em;border-top:2px dashed var(--soft);margin-right:.45em;vertical-align:.25em}
.scroll{overflow-x:auto;margin:0 0 16px}
table{border-collapse:collapse;width:100%;font-size:14px}
th{text-align:left;font-weight:600;color:var(--soft);font-size:12.5px;border-bottom:1px solid var(--line);padding:6px 12px 6px 0;vertical-align:bottom}
td{border-bottom:1px solid var(--line);padding:7px 12px 7px 0;vertical-align:top}
tbody tr:last-child td{border-bottom:0}
th.n,td.n{text-align:right;font-variant-numeric:tabular-nums}
td.n{white-space:nowrap}
.yes{color:var(--good);font-weight:700}.no{color:var(--bad);font-weight:700}
.bar{fill:var(--accent)}.bar.idle{fill:var(--line)}
.axis{stroke:var(--soft);stroke-width:1}
.tick{fill:var(--soft);font-size:11px}.name{fill:var(--ink);font-size:12.5px}
.stage{fill:var(--ink);font-size:14px}.figures{fill:var(--soft);font-size:13.5px}
.missing{border:1px dashed var(--line);border-radius:8px;padding:12px 16px;color:var(--soft);margin:0}
code,.mono{font-family:ui-monospace,"DejaVu Sans Mono",Menlo,monospace;font-size:.9em}
code{background:var(--wash);border-radius:4px;padding:1px 5px}
.mono{overflow-wrap:anywhere}
footer{color:var(--soft);font-size:13px;padding:0 6px}
@media print{body{background:#fff;font-size:11px}main{max-width:none;padding:0}nav{display:none}
header,section{border:0;padding:0 0 14px;break-inside:auto}figure,tr,.verdict,.cards{break-inside:avoid}
h2,h3{break-after:avoid}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}
.three{grid-template-columns:repeat(3,1fr)}.two{grid-template-columns:repeat(2,1fr)}}
)css";

}  // namespace palpate::report
