// A request over HTTP, its limits, and the way it ended. Plain types.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/remote/api/remote_api.h"

namespace gse::remote {

/// One part of a body of multipart/form-data.
struct HttpPart {
    std::string name;
    std::string content;
    std::string file_name = {};     // empty = a plain field
    std::string content_type = {};  // empty = not told
};

/// Bounds of one exchange. The transfer ends as soon as one is passed.
struct HttpLimits {
    std::size_t body_bytes = std::size_t{1} << 20;
    std::size_t header_bytes = std::size_t{64} << 10;
    std::size_t header_lines = 200;
    Milliseconds connect{5'000};
    Milliseconds first_byte{10'000};  // from the request's last byte
    Milliseconds silence{60'000};     // between two bytes, in either direction
    Milliseconds body{600'000};       // from the first byte of the answer to its last
};

struct HttpRequest {
    std::string method = "GET";  // or "POST"
    std::string url;
    std::vector<std::pair<std::string, std::string>> headers = {};
    std::string body = {};             // of a POST without parts
    std::vector<HttpPart> parts = {};  // multipart/form-data instead of a body
    bool repeatable = true;            // false: sent at most once, on a connection of its own
    bool direct = false;               // no proxy, whatever the environment says
    HttpLimits limits = {};
};

/// Name and value of one header line. Names are in small letters.
using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpAnswer {
    int status = 0;
    HttpHeaders headers = {};
    std::string body = {};

    /// Value of the first header of that name (small letters); empty without one.
    std::string header(const std::string& name) const;
};

/// Ways in which an exchange ends without an answer.
enum class HttpFailure {
    None,
    NoHost,      // the name leads nowhere
    NoListener,  // no connection came about
    Tls,         // the certificate is not trusted, or the other side speaks no TLS
    Lost,        // the connection ended before the answer was whole
    Silent,      // no byte came in time
    Slow,        // bytes came, but not all in time
    TooLarge,    // a limit of the body or of the headers was passed
    Encoded,     // the body is compressed, which was not asked for
    NotHttp,     // the bytes are no answer of HTTP
    BadRequest,  // the address or a header cannot be sent
    Stopped,     // the exchange was given up by this side
};

struct HttpResult {
    HttpFailure failure = HttpFailure::None;
    std::string detail = {};  // libcurl's words; for people
    bool connected = false;   // false: the server cannot have seen anything of it
    bool answered = false;    // true: at least one byte of an answer came
    HttpAnswer answer = {};

    bool ok() const { return failure == HttpFailure::None; }
};

}  // namespace gse::remote
