"""What `./dev wheel` finds in a wheel's files, here of wheels made up of one C function each."""

from __future__ import annotations

import json
import subprocess
import zipfile
from pathlib import Path

import check_emulated_wheel
import check_wheel
import pytest

PARTS = ("bullet", "nanobind", "robin-map")
GOOD = "int PyInit__bullet(void) { return 0; }"


def make_wheel(folder: Path, *, code: str = GOOD, parts=PARTS, extra: tuple[str, ...] = ()) -> Path:
    subprocess.run(
        ["cc", "-O2", "-shared", "-fPIC", "-x", "c", "-", "-o", folder / "module.so", "-lm"],
        input=code,
        check=True,
        text=True,
    )
    wheel = folder / "voxshell-0.1.0-cp311-cp311-linux_x86_64.whl"
    bill = {"components": [{"bom-ref": part, "version": "1.2"} for part in parts]}
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.write(folder / "module.so", "voxshell/_bullet.cpython-311-x86_64-linux-gnu.so")
        archive.writestr("voxshell-0.1.0.dist-info/sboms/voxshell.cdx.json", json.dumps(bill))
        for part in PARTS:
            archive.writestr(f"voxshell-0.1.0.dist-info/licenses/licenses/{part}.txt", "MIT")
        for name in extra:
            archive.writestr(name, "")
    return wheel


def test_a_good_wheel_has_no_fault(tmp_path):
    assert check_wheel.find_fault(make_wheel(tmp_path)) is None


def test_a_module_that_calls_pow_of_the_c_library_is_refused(tmp_path):
    power = "double power(double x, double y) { return __builtin_pow(x, y); }"
    code = f'{GOOD} __attribute__((visibility("hidden"))) {power}'
    fault = check_wheel.find_fault(make_wheel(tmp_path, code=code))
    assert fault is not None
    assert "_bullet" in fault
    assert fault.endswith("pow")


def test_a_module_that_shows_more_than_python_calls_is_refused(tmp_path):
    fault = check_wheel.find_fault(make_wheel(tmp_path, code=GOOD + "int more(void) { return 1; }"))
    assert fault is not None
    assert "2 symbols: PyInit__bullet, more" in fault


def test_foreign_files_and_parts_without_an_entry_are_refused(tmp_path):
    fault = check_wheel.find_fault(make_wheel(tmp_path, extra=("voxshell/libother.so.1",)))
    assert fault is not None
    assert fault.endswith("no part of the package: voxshell/libother.so.1")
    fault = check_wheel.find_fault(make_wheel(tmp_path, parts=PARTS[:2]))
    assert fault is not None
    assert fault.endswith("says nothing of robin-map")


def test_a_large_wheel_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(check_wheel, "MOST_BYTES", 1000)
    fault = check_wheel.find_fault(make_wheel(tmp_path))
    assert fault is not None
    assert "it must stay below" in fault


def test_all_functions_that_bullet_replaces_are_looked_for():
    assert {"sin", "cos", "atan2", "pow", "hypot"} <= check_wheel.REPLACED


@pytest.mark.parametrize(
    "tags",
    ["linux_aarch64", "manylinux_2_28_aarch64", "manylinux2014_aarch64.manylinux_2_17_aarch64"],
)
def test_the_emulator_is_that_of_the_wheels_processor(tmp_path, tags):
    python = tmp_path / "usr/bin/python3.11"
    python.parent.mkdir(parents=True)
    python.touch()
    wheel = Path(f"voxshell-0.1.0-cp311-cp311-{tags}.whl")
    command = check_emulated_wheel.emulated_python(wheel, tmp_path)
    assert command[:4] == ["qemu-aarch64", "-L", str(tmp_path), str(python)]


@pytest.mark.parametrize(("emulated", "code"), [("3f", 0), ("40", 1)])
def test_the_emulated_check_fails_where_bits_differ(tmp_path, monkeypatch, capsys, emulated, code):
    pip = tmp_path / "usr/share/python-wheels/pip-23-py3-none-any.whl"
    pip.parent.mkdir(parents=True)
    pip.touch()
    wheel = make_wheel(tmp_path)
    monkeypatch.setattr(check_emulated_wheel, "emulated_python", lambda *_: ["true"])
    monkeypatch.setattr(check_emulated_wheel, "make_environment", lambda *_: Path("python"))

    def run(command, *_):
        return "0.1.0" if "--version" in command else emulated if command[0] == "true" else "3f"

    monkeypatch.setattr(check_emulated_wheel, "_run", run)
    arguments = [str(path) for path in (wheel, wheel, tmp_path / "constraints.txt", tmp_path)]
    assert check_emulated_wheel.main(arguments) == code
    assert ("same bits" in capsys.readouterr().out) == (code == 0)
