// Passwords and tokens of servers: where they are kept, and where they may be sent.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/remote/api/server_url.h"

namespace gse::remote {

/// A token (bearer), or a user name with a password (basic).
struct Credential {
    std::string token = {};
    UrlUser user = {};

    bool empty() const { return token.empty() && user.name.empty() && user.password.empty(); }
    /// Value of the header "Authorization".
    std::string header() const;
};

/// "name:password" is a user; everything else is a token.
Credential credential_of(const std::string& text);

/// servers.json of the user's configuration folder: origin -> {"token"} or {"user", "password"}.
std::filesystem::path credentials_file();

/// The credential of a server: GSEDITPRO_SERVER_TOKEN if it is set, else that of the file. Throws Error
/// (InvalidArgument) for a file that others may read, or if it would go over http to a public address.
std::optional<Credential> find_credential(const ServerUrl& url);

/// Writes the user of an address into the file (mode 0600). Throws Error (Unwritable).
void keep_credential(const ServerUrl& url, const UrlUser& user);

/// Takes the server's entry out of the file, if there is one. Throws Error (Unwritable).
void forget_credential(const ServerUrl& url);

/// Throws Error (InvalidArgument) where a secret would go over http to a public address.
void check_secret_may_go(const ServerUrl& url);

}  // namespace gse::remote
