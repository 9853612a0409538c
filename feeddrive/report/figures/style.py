"""The style sheet of the report: dark on white, one column, good to print."""

STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 28px 20px 60px; max-width: 900px; background: #fff; color: #1c1c1c;
  font: 15px/1.5 "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
h1 { font-size: 25px; line-height: 1.25; margin: 0 0 2px; overflow-wrap: break-word; }
h2 { font-size: 18px; margin: 34px 0 10px; padding-top: 12px; border-top: 1px solid #d9d9d9; }
p { margin: 6px 0; max-width: 75ch; overflow-wrap: break-word; }
.under { color: #5a5a5a; margin-bottom: 16px; }
.verdict { border: 1px solid #e3c9b5; border-left: 6px solid #d55e00; background: #fffaf6; padding: 10px 18px 12px; }
.verdict.clean { border-color: #b9d3e6; border-left-color: #0072b2; background: #f7fbfe; }
.verdict p { max-width: none; }
.main { font-size: 18px; line-height: 1.4; font-weight: 600; }
.note, figcaption { color: #4a4a4a; font-size: 13.5px; max-width: none; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; margin: 6px 0; font-size: 14px;
  font-variant-numeric: tabular-nums lining-nums; }
th { text-align: left; font-weight: 600; color: #4a4a4a; border-bottom: 1.5px solid #6b6b6b; padding: 4px 10px 4px 0;
  vertical-align: bottom; }
td { border-bottom: 1px solid #e6e6e6; padding: 5px 10px 5px 0; vertical-align: top; overflow-wrap: break-word; }
td:not(.number) { min-width: 9ch; }
th.number, td.number { text-align: right; padding-left: 8px; }
td.number { white-space: nowrap; }
.pairs tbody tr:nth-child(odd) td { border-bottom-color: #f3f3f3; }
.effects td:nth-child(2), .effects td:nth-child(5) { white-space: nowrap; }
.dense { font-size: 13px; } .dense td { padding-top: 2px; padding-bottom: 2px; }
code { font: 12.5px/1.4 "DejaVu Sans Mono", Consolas, Menlo, monospace; color: #3a3a3a; }
code.hash { font-size: 10.5px; overflow-wrap: anywhere; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; background: #f5f5f5; padding: 6px 10px;
  font: 12.5px/1.5 "DejaVu Sans Mono", Consolas, Menlo, monospace; }
.form { display: flex; flex-wrap: wrap; gap: 4px 24px; margin: 0 0 14px; font-size: 13.5px; }
.form div { flex: 1 1 150px; border-bottom: 1px solid #b8b8b8; min-height: 38px; }
.form dt { margin: 0; font-weight: 400; color: #5a5a5a; } .form dd { margin: 0; }
dt { font-weight: 600; margin-top: 8px; } dd { margin: 0 0 4px 18px; max-width: 75ch; overflow-wrap: break-word; }
ul { margin: 6px 0; padding-left: 20px; } li { overflow-wrap: break-word; }
figure { margin: 18px 0 26px; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; }
figcaption { margin-top: 6px; }
.tabs > input { position: absolute; opacity: 0; }
.tabs > label { display: inline-block; padding: 5px 16px; margin: 0 4px 12px 0; border: 1px solid #b8b8b8;
  border-radius: 4px; cursor: pointer; }
.tabs > input:checked + label { background: #0072b2; border-color: #0072b2; color: #fff; }
.tabs > input:focus-visible + label { outline: 2px solid #d55e00; }
#tab-bench:not(:checked) ~ .pane-bench, #tab-bench:checked ~ .pane-report { display: none; }
.pane-bench { position: relative; left: 50%; width: min(1400px, 100vw - 24px); transform: translateX(-50%); }
.pane-bench iframe { display: block; width: 100%; height: max(900px, 100vh - 120px); border: 1px solid #d9d9d9; }
@media (max-width: 600px) {
  thead { display: none; }
  tr { display: block; border-bottom: 1px solid #c8c8c8; padding: 4px 0; }
  td, td.number { display: flex; gap: 1em; border: 0; padding: 2px 0; text-align: left; white-space: normal; }
  td::before { content: attr(data-label); flex: 0 0 38%; color: #6b6b6b; }
  td:not([data-label])::before, td:empty { display: none; }
  body { padding: 16px 12px 40px; } h1 { font-size: 21px; } .main { font-size: 16px; }
  .verdict { padding: 8px 12px; } dd { margin-left: 10px; }
}
@media print {
  body { max-width: none; padding: 0; font-size: 10.5pt; }
  h2 { break-after: avoid; } tr, .verdict { break-inside: avoid; }
  .verdict { background: #fff; }
  .tabs > label, .pane-bench { display: none; } #tab-bench:checked ~ .pane-report { display: block; }
}
"""
