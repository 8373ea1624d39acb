"""``python -m rayflock`` is the program."""

import os
import signal
import subprocess
import sys

import pytest
import rayflock


def run(*words, **options):
    command = [sys.executable, "-m", "rayflock", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, **options)


def test_help_is_that_of_the_program():
    done = run("--help")
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage: python -m rayflock <COMMAND>" in done.stdout
    for command in ("demo", "render", "convert", "info", "sun", "sense"):
        assert f"\n  {command} " in done.stdout
    assert run("--version").stdout == f"rayflock {rayflock.__version__}\n"


def test_info_tells_what_is_in_a_scene():
    done = run("info", "builtin:cornell")
    assert (done.returncode, done.stderr) == (0, "")
    assert "cornell" in done.stdout and "triangles" in done.stdout


def test_render_writes_a_picture(tmp_path):
    done = run("render", "builtin:cornell", "--size", "16x12", "-o", tmp_path / "box.png")
    assert (done.returncode, done.stdout) == (0, "")
    png = (tmp_path / "box.png").read_bytes()
    assert png.startswith(b"\x89PNG") and png[16:24] == bytes([0, 0, 0, 16, 0, 0, 0, 12])


def test_sense_writes_the_files_that_python_does(tmp_path):
    options = ("--sensor", "spinning:16", "--at", "2,1.4,0.6", "--columns", "8")
    names = ("a.ply", "a.pcd", "a.csv", "a.npz")
    files = [word for name in names for word in ("-o", tmp_path / name)]
    assert run("sense", "builtin:crowd", *options, *files).returncode == 0
    sensor = rayflock.Sensor("spinning:16", at=(2, 1.4, 0.6), columns=8)
    sweep = rayflock.load("builtin:crowd").sense(sensor)
    for name in names[:3]:
        sweep.save(tmp_path / f"b{name}")
        assert (tmp_path / f"b{name}").read_bytes() == (tmp_path / name).read_bytes(), name


def test_mistakes_have_their_exit_codes(tmp_path):
    for words, code, message in [
        (("paint",), 2, "unrecognized subcommand 'paint'"),
        (("render", "builtin:cornell"), 2, "--output <PATH>"),
        (("info", tmp_path / "gone.glb"), 2, "gone.glb"),
        (("render", "builtin:cornell", "-o", tmp_path / "no" / "x.png"), 1, "cannot write"),
    ]:
        done = run(*words)
        assert done.returncode == code and message in done.stderr, done.stderr
        assert "Traceback" not in done.stderr


def test_a_reader_that_goes_away_is_no_mistake():
    command = [sys.executable, "-m", "rayflock", "info", "builtin:crowd"]
    program = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    program.stdout.close()
    assert (program.wait(120), program.stderr.read()) == (0, b"")
    program.stderr.close()


@pytest.mark.skipif(not hasattr(os, "kill") or os.name == "nt", reason="there are no signals here")
def test_ctrl_c_stops_the_program(tmp_path):
    words = ["render", "builtin:museum7", "--frames", "0..9999", "-o", f"{tmp_path}/out/"]
    command = [sys.executable, "-m", "rayflock", *words, "--size", "32x18"]
    program = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    while not any((tmp_path / "out").glob("frame_*.png")):
        assert program.poll() is None
    program.send_signal(signal.SIGINT)
    _, words = program.communicate(timeout=120)
    assert program.returncode == 130 and "--resume" in words, words
