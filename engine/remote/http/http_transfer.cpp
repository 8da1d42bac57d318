// Exchange under way: waiting, limits of size and of time.
#include "engine/remote/http/http_transfer.h"

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"

namespace gse::remote {
namespace {

constexpr std::chrono::seconds LongestAfterStop{10};

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

}  // namespace

std::string HttpAnswer::header(const std::string& name) const {
    for (const auto& [key, value] : headers)
        if (key == name) return value;
    return {};
}

HttpTransfer::HttpTransfer(HttpRequest asked, FollowUp next, bool in_background,
                           std::function<void()> wake_driver)
    : request(std::move(asked)), follow_up(std::move(next)), background(in_background),
      wake_driver_(std::move(wake_driver)) {
    sent_ = request.body.empty() && request.parts.empty();
    given_up_at_ = Clock::now().time_since_epoch().count();
}

bool HttpTransfer::wait(const std::stop_token& stop, Milliseconds most) {
    std::unique_lock lock(mutex_);
    const bool ended = changed_.wait_for(lock, stop, most, [&] { return result_.has_value(); });
    if (ended || !stop.stop_requested()) return ended;
    lock.unlock();
    give_up();
    throw Error(ErrorCode::Cancelled, "stopped");
}

HttpResult HttpTransfer::take() {
    const std::scoped_lock lock(mutex_);
    return std::move(result_).value_or(HttpResult{HttpFailure::Stopped});
}

void HttpTransfer::give_up() {
    given_up_at_ = Clock::now().time_since_epoch().count();
    given_up_ = true;
    wake_driver_();
}

void HttpTransfer::finish(HttpResult result) {
    const std::scoped_lock lock(mutex_);
    result_ = std::move(result);
    changed_.notify_all();
}

bool HttpTransfer::unwanted(Clock::time_point now) const {
    if (!given_up_ && !background) return false;
    const Clock::time_point since{Clock::duration(given_up_at_.load())};
    return (!background && (!follow_up || !sent_)) || now - since > LongestAfterStop;
}

bool HttpTransfer::fail(HttpFailure why, std::string words) {
    if (failure == HttpFailure::None) {
        failure = why;
        detail = std::move(words);
    }
    return false;
}

bool HttpTransfer::take_header(std::string_view line) {
    touch();
    answered = true;
    header_bytes_ += line.size();
    ++header_lines_;
    if (header_bytes_ > request.limits.header_bytes || header_lines_ > request.limits.header_lines)
        return fail(HttpFailure::TooLarge, "the headers are longer than any server's");
    if (line.starts_with("HTTP/")) {  // also after "100 Continue"
        answer.headers.clear();
        return true;
    }
    const auto colon = line.find(':');
    if (colon == std::string_view::npos) return true;
    std::string name(trimmed(line.substr(0, colon)));
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    std::string value(trimmed(line.substr(colon + 1)));
    if (name == "content-encoding" && value != "identity" && !value.empty())
        return fail(HttpFailure::Encoded, "the answer is compressed, which was not asked for");
    answer.headers.emplace_back(std::move(name), std::move(value));
    return true;
}

bool HttpTransfer::take_body(std::string_view bytes) {
    touch();
    answered = true;
    if (!body_begun_) {
        body_begun_ = true;
        body_began_ = last_byte_;
    }
    if (answer.body.size() + bytes.size() > request.limits.body_bytes)
        return fail(HttpFailure::TooLarge, "the answer is larger than it can be");
    answer.body += bytes;
    return true;
}

void HttpTransfer::take_upload(std::int64_t bytes, std::int64_t total) {
    if (sent_ || bytes == uploaded_) return;
    touch();
    uploaded_ = bytes;
    sent_ = total > 0 && bytes >= total;
}

HttpFailure HttpTransfer::overdue(Clock::time_point now, bool connected) {
    const auto& limits = request.limits;
    const auto quiet = now - last_byte_;
    if (!connected) return HttpFailure::None;  // libcurl has a limit for it
    if (body_begun_ && now - body_began_ > limits.body) return HttpFailure::Slow;
    if (sent_ && !answered) return quiet > limits.first_byte ? HttpFailure::Silent : HttpFailure::None;
    return quiet > limits.silence ? HttpFailure::Silent : HttpFailure::None;
}

}  // namespace gse::remote
