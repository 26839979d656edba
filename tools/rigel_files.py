"""What rigel_plot.py and rigel_claims.py share: reports that are read, files that are written."""
import errno
import fcntl
import json
import os
import stat
import sys
import unicodedata

# Marks that turn the direction of writing, and the byte order mark.
MISLEADING = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\ufeff"


class Bad(Exception):
    """A message for the user."""


def printable(text):
    """Text for a terminal: what it would obey in hexadecimal, as Rigel's programs show it."""
    kept = []
    for character in text:
        if unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp") or character in MISLEADING:
            raw = character.encode("utf-8", "surrogateescape")
            kept.append("".join(f"\\x{byte:02x}" for byte in raw))
        else:
            kept.append(character)
    return "".join(kept)


def open_temporary(place):
    """A locked temporary file beside the place, and its path; what killed runs left is removed."""
    names = [f"{place}.rigel-tmp{k}" for k in range(10)]
    for name in names:
        try:
            with open(name, "rb") as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.path.samestat(os.fstat(file.fileno()), os.lstat(name)):
                    os.unlink(name)
        except OSError:  # not there, or of a living run
            pass
    for name in names:
        try:
            file = open(name, "xb")
        except FileExistsError:
            continue
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:  # a file system without locks, or about to be removed by another run
            pass
        return file, name
    raise OSError(errno.EEXIST, "other runs are writing it")


def write_whole(path, data):
    """As the programs write (rigel/problems/io/whole_file.h): a regular file is replaced by a whole
    one with its mode and owner, all else is written to."""
    place = os.path.realpath(path)
    status = os.stat(path) if os.path.exists(path) else None
    if status and sys.stdout and os.path.samestat(status, os.fstat(sys.stdout.fileno())):
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return
    if status and not stat.S_ISREG(status.st_mode):
        with open(path, "wb") as file:
            file.write(data)
        return
    if status and not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
    file, temporary = open_temporary(place)
    try:
        with file:
            if status:
                own = os.fstat(file.fileno())
                if (own.st_uid, own.st_gid) != (status.st_uid, status.st_gid):
                    os.fchown(file.fileno(), status.st_uid, status.st_gid)
                os.fchmod(file.fileno(), stat.S_IMODE(status.st_mode))
            file.write(data)
            file.flush()
            os.replace(temporary, place)
    except BaseException:
        if os.path.exists(temporary):
            os.unlink(temporary)
        raise


def read_json(path):
    try:
        with open(path, encoding="utf-8-sig") as file:
            value = json.load(file)
    except (OSError, ValueError) as error:
        raise Bad(f"{path}: cannot be read: {error}") from error
    except RecursionError as error:
        raise Bad(f"{path}: cannot be read: nested too deeply") from error
    if not isinstance(value, dict):
        raise Bad(f"{path}: not a report of Rigel")
    return value
