// Sentences about servers that do not answer as they should.
#pragma once

#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/http/http_types.h"

namespace gse::remote {

/// The server's own words in an answer that is an error: texts under error, detail, message and errors, or a
/// web page's title. Printable, at most 300 characters; empty without any.
std::string server_words(const HttpAnswer& answer);

/// Text of a server made fit to be shown: printable, at most 300 characters.
std::string shown(std::string_view text);

/// Some of a server's names, for people: "a, b, ...".
std::string listed(const std::vector<std::string>& names);

/// True for an answer that says that the server's memory did not do.
bool ran_out_of_memory(const HttpAnswer& answer);

/// Error of an answer whose status is not 200 to 299. `with_secret` = a password was sent along.
Error status_error(const HttpAnswer& answer, const ServerUrl& url, bool with_secret);

/// Error of an exchange that ended without an answer.
Error network_error(const HttpResult& result, const ServerUrl& url);

/// Error of an answer that is not what its protocol says.
Error answer_error(const ServerUrl& url, const std::string& what);

/// Throws Error (InvalidArgument) where another model is wanted than the only one that a server has.
void check_only_model(const ServerUrl& url, const std::string& wanted, const std::string& only);

/// Error of work that the server says has failed, in its words.
Error work_error(const ServerUrl& url, std::string_view words);

}  // namespace gse::remote
