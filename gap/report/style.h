#pragma once
// Layout of the printed report.

namespace puckloop::gap::report {

inline constexpr const char* kStyle = R"css(
@page { size: A4; margin: 15mm; }
body { font-family: "DejaVu Sans", Helvetica, Arial, sans-serif; font-size: 9.5pt; line-height: 1.35; color: #222;
       max-width: 180mm; margin: 8mm auto; }
h1 { font-size: 16pt; margin: 0 0 2mm; }
h2 { font-size: 11.5pt; margin: 7mm 0 2mm; border-bottom: 1px solid #999; break-after: avoid; }
h3 { font-size: 10pt; margin: 4mm 0 1mm; break-after: avoid; }
.about { color: #555; font-size: 8.5pt; margin: 0 0 4mm; }
.verdict { border: 1.5px solid #444; border-left-width: 5mm; padding: 3mm 4mm; margin: 3mm 0; break-inside: avoid; }
.verdict.named { border-color: #2e7d4f; } .verdict.no_effect { border-color: #777; }
.verdict.cannot_tell { border-color: #b8860b; } .verdict.unexplained { border-color: #a33; }
.verdict .word { font-size: 13pt; font-weight: bold; }
.verdict p { margin: 1.5mm 0; }
table { border-collapse: collapse; width: 100%; font-size: 8.5pt; margin: 1mm 0 3mm; }
th { text-align: left; border-bottom: 1px solid #444; padding: 0.8mm 2mm 0.8mm 0; font-weight: bold; vertical-align: bottom; }
td { border-bottom: 1px solid #ddd; padding: 0.6mm 2mm 0.6mm 0; vertical-align: top; }
td.n + td:not(.n), th.n + th:not(.n) { padding-left: 3mm; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr { break-inside: avoid; }
.strong { font-weight: bold; }
.faint { color: #888; }
.pictures { display: flex; flex-wrap: wrap; gap: 3mm; }
figure { margin: 0 0 2mm; width: 88mm; break-inside: avoid; }
figure.wide { width: 100%; break-inside: auto; }
figure svg { width: 100%; height: auto; }
figcaption { font-size: 8pt; color: #555; }
ul { margin: 1mm 0; padding-left: 5mm; }
)css";

}  // namespace puckloop::gap::report
