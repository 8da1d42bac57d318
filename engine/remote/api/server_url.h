// Addresses of image servers: checked, taken apart, told private or public. Touches no network.
#pragma once

#include <string>
#include <string_view>

namespace gse::remote {

/// Address of a server, http or https. Equal servers have equal text.
struct ServerUrl {
    std::string scheme = "http";  // or "https"
    std::string host = {};        // in small letters; IPv6 without brackets
    int port = 80;
    std::string path = {};  // of a server below a path: begins with "/", ends without; empty = none

    /// "http://host:port": key of the credentials, and all that is shown or logged.
    std::string origin() const;
    /// The address of something on the server; `place` begins with "/".
    std::string at(std::string_view place) const;
    /// "host:port", for people.
    std::string nickname() const;
    bool encrypted() const { return scheme == "https"; }
};

/// User name and password that stood in an address.
struct UrlUser {
    std::string name = {}, password = {};
};

/// An address with what must not stay in it.
struct TypedUrl {
    ServerUrl url;
    UrlUser user = {};  // to be kept apart; empty = none stood there
};

/// Reads an address as it was typed; "http://" may be left out. Throws Error (InvalidArgument) for another
/// scheme, a query, no host, port 0, numbers that are no usual IPv4 address, or more than 2 KiB.
TypedUrl parse_server_url(std::string_view text);

/// True for this machine itself: localhost, 127.0.0.0/8, ::1.
bool is_loopback(std::string_view host);

/// True for this machine and for addresses of local networks: 10/8, 172.16/12, 192.168/16, 169.254/16,
/// fc00::/7, fe80::/10, and names that end in ".local". Other names are public.
bool is_private(std::string_view host);

/// Bytes other than letters, digits, "-", "_", "." and "~" as %XX.
std::string percent_encoded(std::string_view text);

}  // namespace gse::remote
