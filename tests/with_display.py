"""Runs a command on an X display of its own (Xvfb): with_display.py COMMAND...  Returns the command's exit
code. Without Xvfb the command runs on whatever display there is."""
import os
import shutil
import subprocess
import sys


def main():
    command = sys.argv[1:]
    if shutil.which("Xvfb") is None:
        return subprocess.run(command).returncode
    reader, writer = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(writer), "-screen", "0", "1280x720x24", "-nolisten",
                               "tcp", "-noreset"],
                              pass_fds=[writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(writer)
    try:
        with os.fdopen(reader) as pipe:
            display = pipe.readline().strip()
        if not display:
            print("Xvfb did not start")
            return 1
        return subprocess.run(command, env={**os.environ, "DISPLAY": f":{display}"}).returncode
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    sys.exit(main())
