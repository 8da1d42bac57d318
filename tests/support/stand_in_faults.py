#!/usr/bin/env python3
"""Answers of the stand-in server that break HTTP, JSON or base64 on purpose."""
import base64
import json
import socket
import struct
import time

LONGEST_HANG = 20   # seconds
PAGE = b"<!DOCTYPE html><html><head><title>Just a \x1b[31mproxy</title></head><body>sorry</body></html>"


def raw(handler, data):
    try:
        handler.wfile.write(data)
        handler.wfile.flush()
    except OSError:
        pass
    handler.close_connection = True


def answer(handler, status, kind, body, *more):
    lines = [f"HTTP/1.1 {status} X", f"Content-Type: {kind}", f"Content-Length: {len(body)}", *more]
    raw(handler, ("\r\n".join(lines) + "\r\n\r\n").encode("latin-1") + body)


def is_closed(connection):
    """True when the other side has hung up."""
    connection.setblocking(False)
    try:
        return connection.recv(1, socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except OSError:
        return True
    finally:
        try:
            connection.setblocking(True)
        except OSError:
            pass


def hang(handler):
    end = time.monotonic() + LONGEST_HANG
    while time.monotonic() < end and not is_closed(handler.connection):
        time.sleep(.02)
    handler.close_connection = True


def drip(handler):
    """Sends a byte at a time, for as long as somebody listens."""
    raw(handler, b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: 100000\r\n\r\n")
    end = time.monotonic() + LONGEST_HANG
    try:
        while time.monotonic() < end:
            handler.wfile.write(b" ")
            time.sleep(1 / handler.world.rate)
    except OSError:
        pass


def reset(handler):
    handler.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    handler.connection.close()
    handler.close_connection = True


def redirect(handler):
    target = handler.world.target or f"http://{handler.headers.get('Host')}{handler.path}"
    answer(handler, handler.world.status or 302, "text/plain", b"", "Location: " + target)


def status(handler):
    code = handler.world.status
    more = ["Retry-After: " + handler.world.retry_after] if handler.world.retry_after else []
    if code == 401:
        more.append('WWW-Authenticate: Basic realm="the \x07studio"')
    answer(handler, code, "application/json", json.dumps({"detail": handler.world.words}).encode(), *more)


# Name of a fault -> answer in place of the right one.
TRANSPORT = {
    "hang": hang, "drip": drip, "reset": reset, "redirect": redirect, "status": status,
    "html_500": lambda h: answer(h, 500, "text/html", PAGE),
    "html_200": lambda h: answer(h, 200, "text/html", PAGE),
    "not_found": lambda h: answer(h, 404, "application/json", b'{"detail":"Not Found"}'),
    "validation": lambda h: answer(h, 422, "application/json", json.dumps(
        {"detail": [{"loc": ["body", "width"], "msg": "value is not a valid integer"}]}).encode()),
    "empty": lambda h: answer(h, 200, "application/json", b""),
    "object": lambda h: answer(h, 200, "application/json", b"{}"),
    "list": lambda h: answer(h, 200, "application/json", b"[]"),
    "json_cut": lambda h: answer(h, 200, "application/json", b'{"images": ["iVBOR'),
    "json_deep": lambda h: answer(h, 200, "application/json",
                                  b'{"images":' + b"[" * 200 + b"]" * 200 + b"}"),
    "json_brackets": lambda h: answer(h, 200, "application/json", b"[" * (60 << 20)),
    "json_nan": lambda h: answer(h, 200, "application/json", b'{"progress": NaN}'),
    "json_huge": lambda h: answer(h, 200, "application/json", b'{"progress": 1e999}'),
    "json_utf8": lambda h: answer(h, 200, "application/json", b'{"images": ["\xff\xfe"]}'),
    "out_of_memory": lambda h: answer(h, 500, "application/json", json.dumps(
        {"error": "OutOfMemoryError", "detail": "", "errors": "CUDA out of memory. Tried"}).encode()),
    "length_long": lambda h: raw(h, b"HTTP/1.1 200 OK\r\nContent-Length: 900\r\n\r\n{}"),
    "length_short": lambda h: raw(h, b"HTTP/1.1 200 OK\r\nContent-Length: 1\r\n\r\n{}"),
    "no_length": lambda h: raw(h, b"HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n{}"),
    "bad_chunk": lambda h: raw(h, b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
                                  b"zz\r\n{}\r\n0\r\n\r\n"),
    "gzip": lambda h: answer(h, 200, "application/json", b"\x1f\x8b\x08\0", "Content-Encoding: gzip"),
    "header_long": lambda h: raw(h, b"HTTP/1.1 200 OK\r\nX: " + b"a" * (1 << 20) + b"\r\n\r\n"),
    "header_many": lambda h: raw(h, b"HTTP/1.1 200 OK\r\n" + b"X: a\r\n" * 10000 + b"\r\n"),
    "continue_only": lambda h: (raw(h, b"HTTP/1.1 100 Continue\r\n\r\n"), hang(h)),
    "not_http": lambda h: raw(h, b"SSH-2.0-OpenSSH_9.2\r\n"),
    "no_bytes": lambda h: raw(h, b""),
    "half_header": lambda h: raw(h, b"HTTP/1.1 200 O"),
}


def text_of(data, fault):
    """Base64 of a picture, broken as the fault says."""
    text = base64.b64encode(data).decode()
    if fault == "b64_cut":
        return text[:len(text) // 8 * 4 + 1]
    if fault == "b64_lines":
        return "\n".join(text[i:i + 76] for i in range(0, len(text), 76))
    if fault == "b64_urlsafe":
        return text.replace("+", "-").replace("/", "_")
    if fault == "b64_rubbish":
        return "?" * len(text)
    return text
