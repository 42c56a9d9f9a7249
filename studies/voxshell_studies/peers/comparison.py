"""Comparison of all peers in sequence; rows are stored, so that an interrupted run can resume."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from voxshell.base.outputs import make_folder
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import write_json

from voxshell_studies.convex_parts import CONCAVITY, Parts
from voxshell_studies.part import compute_fingerprint
from voxshell_studies.peers.apart import run_apart
from voxshell_studies.peers.cases import make_job
from voxshell_studies.peers.parts import fetch_parts
from voxshell_studies.peers.protocol import CaseResult, DropResult, PeerResult
from voxshell_studies.peers.roster import PEERS, Prepared, work
from voxshell_studies.peers.truth import Truth, find_truths

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell_studies.peers.apart import Ending
    from voxshell_studies.peers.cases import PeersSettings
    from voxshell_studies.peers.protocol import Case, Job
    from voxshell_studies.peers.roster import Peer

    Progress = Callable[[str, str, float], object]


@dataclass(frozen=True, eq=False)
class Comparison:
    """The results.

    Attributes:
        settings: The settings.
        cases: The cases.
        truths: True depths by case; empty if libigl failed.
        truth_problem: Why it failed.
        peers: A row for each peer.
        environment: Versions, machine, commit.
    """

    settings: PeersSettings
    cases: tuple[Case, ...]
    truths: dict[str, Truth]
    truth_problem: str
    peers: list[PeerResult]
    environment: dict[str, object]

    def true_depth(self, case: Case) -> float:
        """Return the true depth by libigl, or that of the set-up, meters."""
        return self.truths[case.key].depth if case.key in self.truths else case.depth


def compare(
    settings: PeersSettings,
    out: Path,
    *,
    peers: tuple[Peer, ...] = PEERS,
    skip_slow: bool = False,
    progress: Progress = lambda name, stage, fraction: None,
) -> Comparison:
    """Measure peers.

    Args:
        settings: Extent of the measurement.
        out: Folder of finished rows and of the libraries' logs.
        peers: The chosen peers.
        skip_slow: Skip the convex decomposition unless an earlier run has stored it.
        progress: Called with a row's label, the current stage, and the completed fraction.

    Raises:
        MeshError: The bunny is not installed.
        FileAccessError: The folder cannot be written.
    """
    logs = out / "logs"
    make_folder(logs)
    job = make_job(settings)
    parts, parts_ending = None, None
    if any(peer.needs_parts for peer in peers):
        progress("convex parts", "CoACD, some minutes; kept for later runs", 0.0)
        parts, parts_ending = fetch_parts(
            job.mesh,
            limit=settings.parts_time_limit,
            log=logs / "coacd.log",
            only_kept=skip_slow,
        )
        progress("convex parts", "", 1.0)
    truths, truth_problem = _find_truths(job, settings, logs, progress)
    rows = []
    for peer in peers:
        if peer.needs_parts and parts is None:
            assert parts_ending is not None
            rows.append(_row_without_parts(peer, parts_ending, skip_slow))
            progress(peer.label, rows[-1].status, 1.0)
            continue
        rows.append(_measure_or_recall(peer, job, parts, settings, out, progress))
    return Comparison(settings, job.cases, truths, truth_problem, rows, describe_environment())


def measure_peer(
    peer: Peer, job: Job, *, limit: float, log: Path, progress: Progress
) -> PeerResult:
    """Measure one peer in a separate process; always return a row, whatever happens there."""
    row = PeerResult(peer.key, peer.label, "measured", load=os.getloadavg()[0])
    expected = len(job.cases) + 2 * len(job.rates)

    def receive(message: Prepared | CaseResult | DropResult) -> None:
        match message:
            case Prepared():
                row.version, row.settings = message.version, message.settings
                row.timed, row.preparation = message.timed, message.seconds
                stage = "contacts"
            case CaseResult():
                row.cases.append(message)
                stage = f"contacts, {message.case}"
            case DropResult():
                row.drops.append(message)
                stage = f"drop onto the {message.other} at {message.rate:g} Hz"
        progress(peer.label, stage, (len(row.cases) + len(row.drops)) / expected)

    progress(peer.label, "preparing", 0.0)
    ending = run_apart(work, {"peer": peer, "job": job}, receive, limit=limit, log=log)
    if ending.how != "done":
        row.status, row.reason = ending.how, ending.reason
    progress(peer.label, "" if ending.how == "done" else ending.how, 1.0)
    return row


def _measure_or_recall(
    peer: Peer,
    job: Job,
    parts: Parts | None,
    settings: PeersSettings,
    out: Path,
    progress: Progress,
) -> PeerResult:
    path = out / "rows" / f"{peer.key}-{_address(peer, settings, parts)}.json"
    if (kept := _load_row(path)) is not None:
        progress(peer.label, "measured before", 1.0)
        return kept
    if peer.needs_parts and parts is not None:
        job = replace(job, parts=parts.hulls)
    row = measure_peer(
        peer,
        job,
        limit=settings.time_limit,
        log=out / "logs" / f"{peer.key}.log",
        progress=progress,
    )
    if peer.needs_parts and parts is not None:
        row.settings |= {
            "decomposition": f"CoACD {parts.version}, threshold {CONCAVITY:g}",
            "decomposition_seconds": parts.seconds,
        }
    # Missing or failed peers may work the next time.
    if row.status == "measured":
        make_folder(path.parent)
        write_json(path, asdict(row))
    return row


def _row_without_parts(peer: Peer, ending: Ending, skipped: bool) -> PeerResult:
    if skipped and ending.how == "missing":
        reason = "the convex decomposition takes minutes; leave --quick out once to make it"
        return PeerResult(peer.key, peer.label, "skipped", reason)
    status = "failed" if ending.how == "done" else ending.how
    return PeerResult(peer.key, peer.label, status, f"CoACD: {ending.reason}")


def _find_truths(
    job: Job, settings: PeersSettings, logs: Path, progress: Progress
) -> tuple[dict[str, Truth], str]:
    truths: dict[str, Truth] = {}

    def receive(truth: Truth) -> None:
        truths[truth.case] = truth
        progress("true depths", truth.case, len(truths) / len(job.cases))

    progress("true depths", "libigl", 0.0)
    ending = run_apart(
        find_truths, {"job": job}, receive, limit=settings.time_limit, log=logs / "libigl.log"
    )
    progress("true depths", ending.how, 1.0)
    return truths, "" if ending.how == "done" else f"libigl: {ending.how}: {ending.reason}"


def _address(peer: Peer, settings: PeersSettings, parts: Parts | None) -> str:
    """Return a digest of what a row depends on: settings, parts, and the code."""
    digest = hashlib.sha256(compute_fingerprint().encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    digest.update(json.dumps([asdict(peer), asdict(settings)], sort_keys=True).encode())
    if peer.needs_parts and parts is not None:
        for hull in parts.hulls:
            digest.update(hull.tobytes())
    return digest.hexdigest()[:20]


def _load_row(path: Path) -> PeerResult | None:
    try:
        row: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    cases = [CaseResult(**_with_nan(case)) for case in row.pop("cases")]
    drops = [DropResult(**_with_nan(drop)) for drop in row.pop("drops")]
    return PeerResult(**_with_nan(row), cases=cases, drops=drops)


def _with_nan(values: dict[str, Any]) -> dict[str, Any]:
    """Restore numbers that JSON lacks; a depth that a peer does not report stays None."""
    return {
        key: float("nan") if value is None and key != "depth" else value
        for key, value in values.items()
    }
