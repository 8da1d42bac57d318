// libcurl behind the client: easy handles of one multi handle, driven by one thread.
#include "engine/remote/http/http_client.h"

#include <curl/curl.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/error.h"
#include "engine/remote/http/http_transfer.h"

namespace gse::remote {

struct EasyDeleter {
    void operator()(CURL* easy) const { curl_easy_cleanup(easy); }
};
struct MimeDeleter {
    void operator()(curl_mime* mime) const { curl_mime_free(mime); }
};
struct ListDeleter {
    void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

/// One easy handle with all that it points to.
struct EasyTransfer {
    std::shared_ptr<HttpTransfer> transfer;
    std::array<char, CURL_ERROR_SIZE> words{};
    std::unique_ptr<curl_slist, ListDeleter> headers;
    std::unique_ptr<curl_mime, MimeDeleter> mime;
    std::unique_ptr<CURL, EasyDeleter> easy;  // goes first
};

namespace {

constexpr int BusyPollMs = 100, IdlePollMs = 60'000;
constexpr Milliseconds LongestEnd{1'000}, LongestJoin{2'000}, ShortestJoin{50};
constexpr long LongestConnections = 4;

std::size_t on_header(char* data, std::size_t size, std::size_t count, void* transfer) {
    const std::string_view line(data, size * count);
    return static_cast<HttpTransfer*>(transfer)->take_header(line) ? line.size() : 0;
}

std::size_t on_body(char* data, std::size_t size, std::size_t count, void* transfer) {
    const std::string_view bytes(data, size * count);
    return static_cast<HttpTransfer*>(transfer)->take_body(bytes) ? bytes.size() : 0;
}

int on_progress(void* transfer, curl_off_t, curl_off_t, curl_off_t to_send, curl_off_t sent) {
    static_cast<HttpTransfer*>(transfer)->take_upload(sent, to_send);
    return 0;
}

bool set_up_body(EasyTransfer& made) {
    const HttpRequest& request = made.transfer->request;
    CURL* easy = made.easy.get();
    if (request.method != "POST") return true;
    if (request.parts.empty()) {
        curl_easy_setopt(easy, CURLOPT_POST, 1L);
        curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
        curl_easy_setopt(easy, CURLOPT_POSTFIELDS, request.body.data());
        return true;
    }
    made.mime.reset(curl_mime_init(easy));
    if (!made.mime) return false;
    for (const auto& part : request.parts) {
        curl_mimepart* added = curl_mime_addpart(made.mime.get());
        if (added == nullptr || curl_mime_name(added, part.name.c_str()) != CURLE_OK ||
            curl_mime_data(added, part.content.data(), part.content.size()) != CURLE_OK)
            return false;
        if (!part.file_name.empty()) curl_mime_filename(added, part.file_name.c_str());
        if (!part.content_type.empty()) curl_mime_type(added, part.content_type.c_str());
    }
    return curl_easy_setopt(easy, CURLOPT_MIMEPOST, made.mime.get()) == CURLE_OK;
}

bool add_header(EasyTransfer& made, const std::string& line) {
    for (const char c : line)
        if (static_cast<unsigned char>(c) < 32 || c == 127) return false;
    curl_slist* longer = curl_slist_append(made.headers.get(), line.c_str());
    if (longer == nullptr) return false;
    static_cast<void>(made.headers.release());
    made.headers.reset(longer);
    return true;
}

bool set_up_headers(EasyTransfer& made) {
    if (!add_header(made, "Expect:")) return false;
    for (const auto& [name, value] : made.transfer->request.headers)
        if (!add_header(made, name + ": " + value)) return false;
    return curl_easy_setopt(made.easy.get(), CURLOPT_HTTPHEADER, made.headers.get()) == CURLE_OK;
}

void set_up_callbacks(EasyTransfer& made) {
    CURL* easy = made.easy.get();
    HttpTransfer* transfer = made.transfer.get();
    curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, on_header);
    curl_easy_setopt(easy, CURLOPT_HEADERDATA, transfer);
    curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_body);
    curl_easy_setopt(easy, CURLOPT_WRITEDATA, transfer);
    curl_easy_setopt(easy, CURLOPT_XFERINFOFUNCTION, on_progress);
    curl_easy_setopt(easy, CURLOPT_XFERINFODATA, transfer);
    curl_easy_setopt(easy, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, made.words.data());
}

void set_up_connection(EasyTransfer& made, const std::filesystem::path& ca_file) {
    CURL* easy = made.easy.get();
    const HttpRequest& request = made.transfer->request;
    curl_easy_setopt(easy, CURLOPT_URL, request.url.c_str());
    curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
    curl_easy_setopt(easy, CURLOPT_PATH_AS_IS, 1L);
    curl_easy_setopt(easy, CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_1_1));
    curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(request.limits.connect.count()));
    curl_easy_setopt(easy, CURLOPT_TCP_KEEPALIVE, 1L);
    curl_easy_setopt(easy, CURLOPT_TCP_KEEPIDLE, 30L);
    curl_easy_setopt(easy, CURLOPT_DNS_CACHE_TIMEOUT, -1L);  // addresses stay for the session
    curl_easy_setopt(easy, CURLOPT_SSLVERSION, static_cast<long>(CURL_SSLVERSION_TLSv1_2));
    if (!ca_file.empty()) curl_easy_setopt(easy, CURLOPT_CAINFO, ca_file.c_str());
    if (request.direct) {
        curl_easy_setopt(easy, CURLOPT_PROXY, "");
        curl_easy_setopt(easy, CURLOPT_NOPROXY, "*");
    }
    if (!request.repeatable) {  // libcurl sends once more when a kept connection turns out to be closed
        curl_easy_setopt(easy, CURLOPT_FRESH_CONNECT, 1L);
        curl_easy_setopt(easy, CURLOPT_FORBID_REUSE, 1L);
    }
}

/// The handle of an exchange; null where the request cannot be sent.
std::unique_ptr<EasyTransfer> easy_transfer(std::shared_ptr<HttpTransfer> transfer,
                                            const std::filesystem::path& ca_file) {
    auto made = std::make_unique<EasyTransfer>();
    made->transfer = std::move(transfer);
    made->easy.reset(curl_easy_init());
    if (!made->easy || !set_up_headers(*made) || !set_up_body(*made)) return nullptr;
    set_up_callbacks(*made);
    set_up_connection(*made, ca_file);
    return made;
}

HttpFailure failure_of(CURLcode code) {
    switch (code) {
        case CURLE_OK: return HttpFailure::None;
        case CURLE_COULDNT_RESOLVE_HOST:
        case CURLE_COULDNT_RESOLVE_PROXY: return HttpFailure::NoHost;
        case CURLE_COULDNT_CONNECT: return HttpFailure::NoListener;
        case CURLE_OPERATION_TIMEDOUT: return HttpFailure::NoListener;  // the one limit libcurl keeps
        case CURLE_SSL_CONNECT_ERROR:
        case CURLE_PEER_FAILED_VERIFICATION:
        case CURLE_SSL_CERTPROBLEM:
        case CURLE_SSL_CIPHER:
        case CURLE_SSL_ISSUER_ERROR:
        case CURLE_SSL_CACERT_BADFILE: return HttpFailure::Tls;
        case CURLE_WEIRD_SERVER_REPLY:
        case CURLE_UNSUPPORTED_PROTOCOL:
        case CURLE_BAD_CONTENT_ENCODING: return HttpFailure::NotHttp;
        case CURLE_URL_MALFORMAT: return HttpFailure::BadRequest;
        case CURLE_OUT_OF_MEMORY: return HttpFailure::TooLarge;  // said of a header line that has no end
        default: return HttpFailure::Lost;
    }
}

bool has_connection(CURL* easy) {
    curl_off_t microseconds = 0;
    curl_easy_getinfo(easy, CURLINFO_PRETRANSFER_TIME_T, &microseconds);
    return microseconds > 0;
}

HttpResult result_of(EasyTransfer& done, CURLcode code) {
    HttpTransfer& transfer = *done.transfer;
    HttpResult result;
    result.failure = transfer.failure != HttpFailure::None ? transfer.failure : failure_of(code);
    result.detail = !transfer.detail.empty() ? transfer.detail
                    : done.words[0] != 0     ? std::string(done.words.data())
                    : code != CURLE_OK       ? std::string(curl_easy_strerror(code))
                                             : std::string();
    result.connected = has_connection(done.easy.get());
    result.answered = transfer.answered;
    long status = 0;
    curl_easy_getinfo(done.easy.get(), CURLINFO_RESPONSE_CODE, &status);
    result.answer = std::move(transfer.answer);
    result.answer.status = static_cast<int>(status);
    return result;
}

}  // namespace

/// Thread that drives the exchanges of one client. It outlives the client while a name is looked up.
class HttpClient::Driver : public std::enable_shared_from_this<HttpClient::Driver> {
public:
    explicit Driver(std::filesystem::path ca_file) : ca_file_(std::move(ca_file)) {
        static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
        multi_ = ready == CURLE_OK ? curl_multi_init() : nullptr;
        if (multi_ == nullptr) throw Error(ErrorCode::Foreign, "libcurl cannot be started");
        curl_multi_setopt(multi_, CURLMOPT_MAX_TOTAL_CONNECTIONS, LongestConnections);
        curl_multi_setopt(multi_, CURLMOPT_PIPELINING, static_cast<long>(CURLPIPE_NOTHING));
    }
    ~Driver() {
        for (auto& running : running_) {
            curl_multi_remove_handle(multi_, running->easy.get());
            running->transfer->finish({HttpFailure::Stopped});
        }
        for (auto& transfer : arrived_) transfer->finish({HttpFailure::Stopped});
        running_.clear();
        curl_multi_cleanup(multi_);
    }
    Driver(const Driver&) = delete;
    Driver& operator=(const Driver&) = delete;

    void begin() {
        thread_ = std::thread([self = shared_from_this()] { self->drive(); });
    }

    std::shared_ptr<HttpTransfer> add(HttpRequest request, FollowUp follow_up, bool background) {
        auto wake = [weak = weak_from_this()] {
            if (const auto self = weak.lock()) self->wake();
        };
        auto transfer =
            std::make_shared<HttpTransfer>(std::move(request), std::move(follow_up), background, wake);
        if (background) ++background_;
        {
            const std::scoped_lock lock(mutex_);
            arrived_.push_back(transfer);
        }
        wake();
        return transfer;
    }

    /// Lets what nobody waits for end, and the thread with it. Leaves the thread alone where a name is being
    /// looked up, which cannot be broken off.
    void end() {
        closing_ = true;
        wake();
        std::unique_lock lock(mutex_);
        const auto most = background_ > 0 ? LongestJoin : ShortestJoin;
        const bool ended = ended_.wait_for(lock, most, [&] { return has_ended_; });
        lock.unlock();
        if (ended) thread_.join();
        else thread_.detach();
    }

private:
    void wake() { curl_multi_wakeup(multi_); }

    void drive() {
        auto closed_at = HttpTransfer::Clock::time_point::max();
        while (true) {
            take_arrivals();
            int running = 0;
            curl_multi_perform(multi_, &running);
            reap_finished();
            reap_unwanted();
            const auto now = HttpTransfer::Clock::now();
            if (closing_) {
                closed_at = std::min(closed_at, now);
                if ((running_.empty() && !has_arrivals()) || now - closed_at > LongestEnd) break;
            }
            curl_multi_poll(multi_, nullptr, 0, running_.empty() && !closing_ ? IdlePollMs : BusyPollMs,
                            nullptr);
        }
        const std::scoped_lock lock(mutex_);
        has_ended_ = true;
        ended_.notify_all();
    }

    bool has_arrivals() {
        const std::scoped_lock lock(mutex_);
        return !arrived_.empty();
    }

    void take_arrivals() {
        std::vector<std::shared_ptr<HttpTransfer>> arrivals;
        {
            const std::scoped_lock lock(mutex_);
            arrivals.swap(arrived_);
        }
        for (const auto& transfer : arrivals) {
            auto made = easy_transfer(transfer, ca_file_);
            if (!made || curl_multi_add_handle(multi_, made->easy.get()) != CURLM_OK) {
                transfer->finish({HttpFailure::BadRequest, "the request cannot be sent"});
                if (transfer->background) --background_;
                continue;
            }
            running_.push_back(std::move(made));
        }
    }

    void reap_finished() {
        int left = 0;
        while (const CURLMsg* message = curl_multi_info_read(multi_, &left)) {
            if (message->msg != CURLMSG_DONE) continue;
            const CURLcode code = message->data.result;
            const auto done = std::find_if(running_.begin(), running_.end(), [&](const auto& running) {
                return running->easy.get() == message->easy_handle;
            });
            if (done != running_.end()) settle(done, code);
        }
    }

    /// Ends what nobody wants any more, and what is overdue.
    void reap_unwanted() {
        const auto now = HttpTransfer::Clock::now();
        for (std::size_t i = running_.size(); i-- > 0;) {
            HttpTransfer& transfer = *running_[i]->transfer;
            const auto place = running_.begin() + static_cast<std::ptrdiff_t>(i);
            if (transfer.unwanted(now)) {
                transfer.failure = HttpFailure::Stopped;
                settle(place, CURLE_ABORTED_BY_CALLBACK);
                continue;
            }
            const auto late = transfer.overdue(now, has_connection(running_[i]->easy.get()));
            if (late == HttpFailure::None) continue;
            transfer.failure = late;
            transfer.detail =
                late == HttpFailure::Slow ? "the answer takes too long" : "no byte came in time";
            settle(place, CURLE_ABORTED_BY_CALLBACK);
        }
    }

    void settle(std::vector<std::unique_ptr<EasyTransfer>>::iterator place, CURLcode code) {
        const auto done = std::move(*place);
        running_.erase(place);
        auto result = result_of(*done, code);
        curl_multi_remove_handle(multi_, done->easy.get());
        HttpTransfer& transfer = *done->transfer;
        if (transfer.followed() && result.failure != HttpFailure::Stopped)
            if (auto next = transfer.follow_up(result))
                add(std::move(next->request), std::move(next->then), true);
        transfer.finish(std::move(result));
        if (transfer.background) --background_;
    }

    const std::filesystem::path ca_file_;
    CURLM* multi_ = nullptr;
    std::vector<std::unique_ptr<EasyTransfer>> running_;  // of the driving thread
    std::atomic<bool> closing_ = false;
    std::atomic<int> background_ = 0;  // exchanges that nobody waits for
    std::thread thread_;
    std::mutex mutex_;
    std::condition_variable ended_;
    bool has_ended_ = false;
    std::vector<std::shared_ptr<HttpTransfer>> arrived_;
};

HttpExchange::HttpExchange(std::shared_ptr<HttpTransfer> transfer) : transfer_(std::move(transfer)) {}
HttpExchange::HttpExchange(HttpExchange&&) noexcept = default;
HttpExchange::~HttpExchange() {
    if (transfer_) transfer_->give_up();
}

bool HttpExchange::wait(const std::stop_token& stop, Milliseconds most) {
    return transfer_->wait(stop, most);
}

HttpResult HttpExchange::take() { return transfer_->take(); }

HttpClient::HttpClient(std::filesystem::path ca_file)
    : driver_(std::make_shared<Driver>(std::move(ca_file))) {
    driver_->begin();
}

HttpClient::~HttpClient() { driver_->end(); }

HttpExchange HttpClient::start(HttpRequest request, FollowUp after_stop) {
    return HttpExchange(driver_->add(std::move(request), std::move(after_stop), false));
}

HttpResult HttpClient::send(HttpRequest request, const std::stop_token& stop, FollowUp after_stop) {
    auto exchange = start(std::move(request), std::move(after_stop));
    while (!exchange.wait(stop, std::chrono::hours(1))) {}
    return exchange.take();
}

void HttpClient::send_later(HttpRequest request, FollowUp then) {
    driver_->add(std::move(request), std::move(then), true);
}

void wait_stoppable(const std::stop_token& stop, Milliseconds time) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any stopped;
    stopped.wait_for(lock, stop, time, [] { return false; });
    if (stop.stop_requested()) throw Error(ErrorCode::Cancelled, "stopped");
}

}  // namespace gse::remote
