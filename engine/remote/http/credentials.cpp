// Passwords and tokens from the environment or a file that only its owner may read.
#include "engine/remote/http/credentials.h"

#include <sys/stat.h>

#include <cstdlib>
#include <span>

#include <fmt/format.h>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/pending_file.h"
#include "engine/io/files/user_files.h"
#include "engine/remote/picture/base64.h"

namespace gse::remote {
namespace {

std::string text_at(const nlohmann::json& object, const char* name) {
    const auto found = object.find(name);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

void check_mode(const std::filesystem::path& file) {
    struct stat status {};
    if (stat(file.c_str(), &status) == 0 && (status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        throw Error(ErrorCode::InvalidArgument, "the file of passwords can be read by others",
                    "make it yours alone (chmod 600)", file);
}

nlohmann::json kept_credentials(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) return nlohmann::json::object();
    check_mode(file);
    auto json = with_path(file, [&] { return parse_json(read_file(file), "the file of passwords"); });
    if (!json.is_object())
        throw Error(ErrorCode::Malformed, "the file of passwords is no JSON object", "delete it", file);
    return json;
}

/// Mode 0600 from the beginning.
void write_credentials(const std::filesystem::path& path, const nlohmann::json& all) {
    PendingFile file(path);
    std::filesystem::permissions(file.temporary(),
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    file.write(json_text(all, 2) + "\n");
    file.commit();
}

std::optional<Credential> credential_in_file(const ServerUrl& url) {
    const auto all = kept_credentials(credentials_file());
    const auto entry = all.find(url.origin());
    if (entry == all.end() || !entry->is_object()) return std::nullopt;
    Credential found{text_at(*entry, "token"), {text_at(*entry, "user"), text_at(*entry, "password")}};
    if (found.empty()) return std::nullopt;
    return found;
}

}  // namespace

std::string Credential::header() const {
    if (!token.empty()) return "Bearer " + token;
    const std::string pair = user.name + ":" + user.password;
    return "Basic " + base64_encoded(std::as_bytes(std::span(pair)));
}

Credential credential_of(const std::string& text) {
    const auto colon = text.find(':');
    if (colon == std::string::npos) return {text, {}};
    return {{}, {text.substr(0, colon), text.substr(colon + 1)}};
}

std::filesystem::path credentials_file() { return config_folder() / "servers.json"; }

std::optional<Credential> find_credential(const ServerUrl& url) {
    const char* variable = std::getenv("GSEDITPRO_SERVER_TOKEN");
    auto found = variable != nullptr && *variable != 0 ? std::optional(credential_of(variable))
                                                       : credential_in_file(url);
    if (found) check_secret_may_go(url);
    return found;
}

void keep_credential(const ServerUrl& url, const UrlUser& user) {
    const auto path = credentials_file();
    auto all = kept_credentials(path);
    all[url.origin()] = {{"user", user.name}, {"password", user.password}};
    write_credentials(path, all);
}

void forget_credential(const ServerUrl& url) {
    const auto path = credentials_file();
    auto all = kept_credentials(path);
    if (all.erase(url.origin()) > 0) write_credentials(path, all);
}

void check_secret_may_go(const ServerUrl& url) {
    if (!url.encrypted() && !is_private(url.host))
        throw Error(ErrorCode::InvalidArgument,
                    fmt::format("a password would go unencrypted to {}", url.nickname()),
                    "use its https:// address; or, in your own network, its number");
}

}  // namespace gse::remote
