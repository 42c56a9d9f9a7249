"""The report of all experiments: one offline page, and the same rows as JSON."""

from __future__ import annotations

import base64
from html import escape
from itertools import groupby
from typing import TYPE_CHECKING, Any

from voxshell.base.outputs import write_text
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import write_json

from voxshell_studies.part import plain
from voxshell_studies.report.markdown import write_markdown
from voxshell_studies.reproduction import describe_rows
from voxshell_studies.scenes.bunny import ORIENTATIONS_WXYZ
from voxshell_studies.verdict import format_value

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from voxshell_studies.experiment import Picture
    from voxshell_studies.reproduction import Finding
    from voxshell_studies.verdict import Row

PAGE, ROWS, TEXT = "index.html", "report.json", "report.md"

_MEDIA = {".png": "image/png", ".gif": "image/gif"}

# The page uses no network, and tells the browser to forbid it.
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"

_STYLE = """
body { margin: 0 auto; padding: 2rem 1.2rem 5rem; max-width: 68rem; color: #222;
  font: 16px/1.5 system-ui, sans-serif; }
h1 { font-size: 1.9rem; margin: 0 0 .3rem; } h2 { margin: 3.2rem 0 .4rem; font-size: 1.45rem; }
h3 { margin: 1.4rem 0 .3rem; font-size: 1.05rem; } p { max-width: 48rem; }
.faint, figcaption { color: #667; font-size: .9rem; } nav a { margin-right: 1rem; }
table { border-collapse: collapse; width: 100%; font-size: .86rem; margin: .6rem 0; }
th { text-align: left; border-bottom: 2px solid #ccd; } td { border-bottom: 1px solid #e6e8ee; }
.group { padding-top: 1.1rem; border-bottom: 1px solid #ccd; }
th, td { padding: .25rem .6rem .25rem 0; vertical-align: top; }
.number { text-align: right; white-space: nowrap; font-variant-numeric: tabular-nums; }
.good { color: #0b6e4f; } .bad { color: #b3263c; } .verdict { white-space: nowrap; }
.note { color: #667; } figure { margin: 1rem 0; } img { max-width: 100%; height: auto; }
code { font-size: .85rem; } details { margin: .6rem 0; }
"""


def write_report(out: Path, findings: list[Finding], *, command: str) -> None:
    """Write the page, the rows, and the verdicts as a text.

    Args:
        out: The folder that contains the experiments' folders.
        findings: Results of all experiments, in the order of the report.
        command: The command that made the report.
    """
    environment = describe_environment()
    rows = [row for each in findings for row in describe_rows(each.study, each.rows)]
    write_json(
        out / ROWS,
        {
            "command": command,
            "rows": rows,
            "settings": {
                each.study.experiment.name: plain(each.study.settings) for each in findings
            },
            "orientations_wxyz": [list(quaternion) for quaternion in ORIENTATIONS_WXYZ],
            "environment": environment,
        },
    )
    write_markdown(out / TEXT, findings, command=command)
    sections = [_tell(out, each) for each in findings]
    html = _PAGE.format(
        policy=escape(_POLICY, quote=True),
        style=_STYLE,
        links=" ".join(
            f'<a href="#{each.study.experiment.name}">{escape(each.study.experiment.title)}</a>'
            for each in findings
        ),
        command=escape(command),
        machine=escape(
            f"{environment['cpu']}, {environment['cores']} cores, Bullet {environment['bullet']}, "
            f"voxshell {environment['voxshell']} at {environment['commit'] or 'an unknown commit'}"
        ),
        summary=_summarize(findings),
        shortfalls=_list_shortfalls(findings),
        sections="\n".join(sections),
        made=_tell_environment(environment),
    )
    write_text(out / PAGE, html)


_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Section 5.3, re-run</title><style>{style}</style></head><body>
<h1>Section 5.3, re-run</h1>
<p>The evaluation of Voxmap-PointShell collision in the physics engine Bullet (M. Sagardia, <i>Virtual
Manipulations with Force Feedback in Complex Interaction Scenarios</i>, section 5.3), done again with
voxshell, and what goes beyond it. Every figure and verdict here is computed from the data beside this
page. Absolute times are this machine's: compare ratios, orders and flatness.</p>
<p class="faint">{machine}<br><code>{command}</code></p>
<nav>{links}</nav>
<h2>Verdicts</h2>{summary}
<h3>What falls short, or differs from what was published</h3>{shortfalls}
{sections}
{made}
</body></html>
"""


def _summarize(findings: Iterable[Finding]) -> str:
    lines = []
    for each in findings:
        published = [row.reproduced for row in each.rows if row.reproduced is not None]
        held = [row.holds for row in each.rows if row.holds is not None]
        experiment = each.study.experiment
        lines.append(
            f'<tr><td><a href="#{experiment.name}">{escape(experiment.title)}</a></td>'
            f"<td>{escape(experiment.question)}</td>{_count(published)}{_count(held)}</tr>"
        )
    return (
        '<table><tr><th>experiment</th><th>question</th><th class="number">reproduced</th>'
        f'<th class="number">our bars held</th></tr>{"".join(lines)}</table>'
    )


def _count(verdicts: list[bool]) -> str:
    if not verdicts:
        return '<td class="number"></td>'
    kind = "good" if all(verdicts) else "bad"
    return f'<td class="number {kind}">{sum(verdicts)} of {len(verdicts)}</td>'


def _list_shortfalls(findings: Iterable[Finding]) -> str:
    items = [
        f"<li>{escape(each.study.experiment.title)}: {escape(row.quantity)}: "
        f"{escape(_describe(row))}<span class=note>{'; ' + escape(row.note) if row.note else ''}</span></li>"
        for each in findings
        for row in each.rows
        if row.reproduced is False or row.holds is False
    ]
    return f"<ul>{''.join(items)}</ul>" if items else "<p>Nothing.</p>"


def _describe(row: Row) -> str:
    text = f"{format_value(row.here)} {row.unit}".strip()
    if row.reproduced is False:
        text += f", published {format_value(row.published)}"
    if row.holds is False:
        text += f", to be {row.bar}"
    return text


def _tell(out: Path, finding: Finding) -> str:
    experiment, settings = finding.study.experiment, finding.study.settings
    pictures = "".join(_show(out, experiment.name, picture) for picture in finding.pictures)
    lines = _make_lines(finding.rows)
    kind = "" if experiment.published else '<p class="faint">Beyond the section.</p>'
    values = ", ".join(f"{key} = {value}" for key, value in plain(settings).items())
    return f"""<h2 id="{experiment.name}">{escape(experiment.title)}</h2>{kind}
<h3>Question</h3><p>{escape(experiment.question)}</p>
<h3>Set-up</h3><p>{escape(experiment.describe(settings))}</p>
<details><summary class="faint">settings</summary><code>{escape(values)}</code></details>
<h3>Result</h3>{pictures}
<h3>Verdict</h3>
<table><tr><th>quantity</th><th class="number">published</th><th class="number">here</th><th>unit</th>
<th>required of voxshell</th><th>verdict</th></tr>{lines}</table>"""


def _show(out: Path, folder: str, picture: Picture) -> str:
    path = out / folder / picture.path
    caption = escape(picture.caption)
    if path.suffix not in _MEDIA:
        return f'<p><a href="{folder}/{picture.path}">Replay</a>: {caption}</p>'
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return (
        f'<figure><img alt="{caption}" src="data:{_MEDIA[path.suffix]};base64,{data}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )


def _make_lines(rows: Iterable[Row]) -> str:
    return "".join(
        f'<tr><th class="group" colspan="6">{escape(group)}</th></tr>{"".join(map(_make_line, members))}'
        if group
        else "".join(map(_make_line, members))
        for group, members in groupby(rows, key=lambda row: row.group)
    )


def _make_line(row: Row) -> str:
    said = row.reproduced is not None or row.holds is not None
    good = row.reproduced is not False and row.holds is not False
    kind = ("good" if good else "bad") if said else "faint"
    note = f'<br><span class="note">{escape(row.note)}</span>' if row.note else ""
    return (
        f'<tr><td>{escape(row.below_heading)}{note}</td><td class="number">'
        f'{escape(format_value(row.published))}</td><td class="number">{format_value(row.here)}</td>'
        f"<td>{escape(row.unit)}</td><td>{escape(row.bar)}</td>"
        f'<td class="verdict {kind}">{row.verdict}</td></tr>'
    )


def _tell_environment(environment: dict[str, Any]) -> str:
    libraries = ", ".join(f"{name} {version}" for name, version in environment["libraries"].items())
    quaternions = "; ".join(
        f"{number}: ({', '.join(f'{x:g}' for x in quaternion)})"
        for number, quaternion in enumerate(ORIENTATIONS_WXYZ)
    )
    return f"""<h2>Made with</h2>
<p>Peers run at their best: the same Bullet with the same build flags, Bullet's own solver settings (GImpact with two friction directions), and
the least collision margin (of 1, 5, 10 and 20 mm) with which all of them stay on the block; GImpact on
the full mesh; the hull in the 42 directions of btShapeHull; V-HACD's 8 hulls of at most 100 vertices;
HACD's, as many and as large, of the mesh simplified to within 0.5 % of its size, concavity 100, compacity 0.1;
CoACD's at a concavity of 0.05.
Untimed parts ran on all cores, timed ones alone, pinned to one core.</p>
<p>Python {escape(str(environment["python"]))}, {escape(libraries)}; {escape(str(environment["system"]))}.</p>
<details><summary class="faint">orientations of the bunny, (w, x, y, z)</summary>
<code>{escape(quaternions)}</code></details>"""
