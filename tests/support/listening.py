"""Sockets at which processes wait for others, as Linux lists them."""

from pathlib import Path

from process_tree import text_of

_WAITS = 0x10000  # flag of a socket of this machine that others may connect to


def listening(processes):
    """A line for each socket of the processes at which anybody may knock."""
    own = set()
    for process in processes:
        for link in Path(f"/proc/{process}/fd").glob("*"):
            try:
                own.add(str(link.readlink()))
            except OSError:
                continue  # closed or ended meanwhile
    return [line for inode, line in _open_to_others() if f"socket:[{inode}]" in own]


def _open_to_others():
    for name in ("tcp", "tcp6", "udp", "udp6"):
        for line in text_of(Path("/proc/net") / name).splitlines()[1:]:
            words = line.split()
            if name.startswith("udp") or words[3] == "0A":  # LISTEN
                yield words[9], f"{name} {words[1]}"
    for line in text_of(Path("/proc/net/unix")).splitlines()[1:]:
        words = line.split()
        if int(words[3], 16) & _WAITS:
            yield words[6], f"unix {words[7:]}"
