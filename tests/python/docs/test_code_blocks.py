"""What the pages print runs as printed: Python, shell commands, C++."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import code_blocks
import pytest
import trimesh
from code_blocks import ROOT, Block, all_blocks
from voxshell.simulation.live_view import LiveView, Page

BUILD = ROOT / "build/release"  # where ./dev builds
# Commands that are not run here, each with the reason: patterns of their beginnings.
NOT_RUN = {
    r"git clone <": "there is no address to clone from",
    r"\./dev ": "prepares or tests this whole checkout, as the run that this test is part of did",
    r"VOXSHELL_POSES=\d+ \./dev ": "takes hours",
    r"cmake (-S |--build |--install )": "C++ test: build_example.cmake",
    r"(export PKG_CONFIG_PATH|g\+\+ -O2 app.cpp)": "C++ test: build_example.cmake does so",
    r"\.venv/bin/voxshell reproduce all ": "takes minutes; tests/python/cli runs its parts",
    r"voxshell reproduce geometry ": "takes minutes; tests/python/cli runs it small",
    r"voxshell reproduce (everyday|limits) ": "takes minutes; tests/python/cli runs it small",
    r"pip install --find-links build/dist ": "./dev wheel installs what it makes",
    r"docker (build|run) ": "needs a program that builds containers",
    r"voxshell simulate examples/": "tests/python/cli/test_simulate_scene.py runs the scenes",
}
# Blocks that stand four to the right and are no commands, by how they begin.
NO_COMMANDS = {
    "find_package(": "CMake; build_example.cmake builds examples/bullet in this way",
}
# What the text around a block of C++ says is there.
CPP_SURROUNDINGS = {
    "README.md": "btDynamicsWorld& world",
    "docs/porting-to-voxshell.md": (
        "btDynamicsWorld& world, double kilograms, const voxshell::Pose& world_from_mesh"
    ),
}
CPP_HEADERS = """
#include <stdexcept>
#include <vector>
#include <btBulletDynamicsCommon.h>
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where readers are: with a part.stl of their own, in millimeters."""
    monkeypatch.chdir(tmp_path)
    part = trimesh.creation.torus(30.0, 10.0)
    part.export(tmp_path / "part.stl")
    return tmp_path


def run_python(block: Block) -> None:
    exec(compile("\n" * (block.line - 1) + block.code, block.page, "exec"), {})


def list_commands(block: Block) -> list[str]:
    """Its lines without their comments."""
    return [
        command for line in block.code.splitlines() if (command := re.sub(r"\s+# .*", "", line))
    ]


def reason_not_to_run(command: str) -> str | None:
    """Why a command is not run here, if so."""
    return next((why for start, why in NOT_RUN.items() if re.match(start, command)), None)


def run_command(command: str) -> None:
    programs = Path(sys.executable).parent
    command = command.replace(".venv/bin/", f"{shlex.quote(str(programs))}/")
    path = f"{programs}:{os.environ['PATH']}"
    subprocess.run(["bash", "-euc", command], check=True, env={**os.environ, "PATH": path})


def link_cpp(block: Block, folder: Path) -> subprocess.CompletedProcess[str]:
    """Whether it compiles and links inside a function that has what the text says is there."""
    includes = re.findall(r"^#include .*$", block.code, re.M)
    rest = re.sub(r"^#include .*$", "", block.code, flags=re.M)
    arrays = "const std::vector<voxshell::Vec3>& vertices, const std::vector<voxshell::Triangle>& triangles"
    source = folder / "block.cpp"
    source.write_text(
        "\n".join(includes)
        + CPP_HEADERS
        + f"void block({CPP_SURROUNDINGS[block.page]}, {arrays}) {{\n{rest}\n}}\nint main() {{}}\n"
    )
    compiler = os.environ.get("CXX") or shutil.which("c++") or "g++"
    cflags, libs = (
        shlex.split(
            subprocess.run(
                ["pkg-config", option, "bullet"], capture_output=True, text=True, check=True
            ).stdout
        )
        for option in ("--cflags", "--libs")
    )
    headers = [f"-I{ROOT / 'core/include'}", f"-I{ROOT / 'bullet/include'}"]
    libraries = [
        str(BUILD / "bullet/libvoxshell_bullet.a"),
        str(BUILD / "core/libvoxshell_core.a"),
    ]
    return subprocess.run(
        [
            *(compiler, "-std=c++20", *headers, *cflags, str(source)),
            *(*libraries, *libs, "-pthread", "-o", str(folder / "block")),
        ],
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("block", all_blocks("python"), ids=str)
def test_python_runs(block: Block, folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("voxshell.simulation.live_view.FIRST_PAGE", 0.01)  # nobody opens it here
    opened = LiveView.open

    def open_and_resume(view: LiveView, make_page: Callable[[], Page]) -> None:
        opened(view, make_page)
        view.resume()  # nobody presses the button here

    monkeypatch.setattr(LiveView, "open", open_and_resume)
    run_python(block)


@pytest.mark.parametrize("block", all_blocks("indented", "sh", "bash", "shell"), ids=str)
def test_commands_run(block: Block, folder: Path):
    if any(block.code.startswith(start) for start in NO_COMMANDS):
        return
    for command in list_commands(block):
        if reason_not_to_run(command) is None:
            run_command(command)


@pytest.mark.parametrize("block", all_blocks("cpp"), ids=str)
def test_cpp_links(block: Block, folder: Path):
    done = link_cpp(block, folder)
    assert done.returncode == 0, done.stderr


def test_there_is_code_on_the_pages_and_every_exception_is_used():
    assert len(all_blocks("python")) >= 5
    assert len(all_blocks("cpp")) >= 2
    commands = [c for block in all_blocks("indented") for c in list_commands(block)]
    for start in NOT_RUN:
        assert any(re.match(start, command) for command in commands), start
    for start in NO_COMMANDS:
        assert any(block.code.startswith(start) for block in all_blocks("indented")), start


def test_blocks_are_found_where_they_stand(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("Text\n\n    a b  # c\n    d\n\n- item\n  more\n\n```python\nx = 1\n```\n")
    blocks = code_blocks.read_blocks(page)
    assert [(b.line, b.language, b.code) for b in blocks] == [
        (3, "indented", "a b  # c\nd"),
        (10, "python", "x = 1"),
    ]
    assert list_commands(blocks[0]) == ["a b", "d"]


def test_broken_blocks_are_noticed(folder):
    """The readers' own mistakes are not what is looked for: ours are."""
    good = all_blocks("python")[0]
    with pytest.raises(TypeError):
        run_python(
            Block(good.page, 1, "python", good.code.replace("vx.contacts(", "vx.contacts(1, "))
        )
    good = all_blocks("cpp")[0]
    wrong = good.code.replace("ModelShape shape", "ModelShapes shape")
    assert wrong != good.code
    assert "ModelShapes" in link_cpp(Block(good.page, 1, "cpp", wrong), folder).stderr
    nowhere = good.code + "\nvoid declared_only(); declared_only();"
    assert "declared_only" in link_cpp(Block(good.page, 1, "cpp", nowhere), folder).stderr
    with pytest.raises(subprocess.CalledProcessError):
        run_command("voxshell rebuild part.stl")
