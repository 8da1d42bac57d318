// Stand-in server as a child process of the test.
#include "tests/stress/remote/stand_in.h"

#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "engine/base/json.h"
#include "engine/io/image/media.h"
#include "engine/remote/api/server_url.h"
#include "engine/remote/http/http_client.h"
#include "tests/test_paths.h"

extern char** environ;

namespace gse::remote {
namespace {

/// Starts the program with its output in a pipe; gives the end to read from.
int spawn(const std::vector<std::string>& words, pid_t& process) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    std::vector<char*> argv;
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const int failed = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    if (failed != 0) {
        close(ends[0]);
        return -1;
    }
    return ends[0];
}

std::string first_line(int descriptor) {
    std::string line;
    char letter = 0;
    while (read(descriptor, &letter, 1) == 1 && letter != '\n') line += letter;
    return line;
}

std::string query_of(const Knobs& knobs) {
    std::string query;
    for (const auto& [name, value] : knobs)
        query += (query.empty() ? "?" : "&") + name + "=" + percent_encoded(value);
    return query;
}

/// The interpreter itself, behind scripts that choose one; empty where there is none.
const std::string& python() {
    static const std::string program = [] {
        pid_t process = -1;
        const int output = spawn({GSE_PYTHON, "-c", "import sys; print(sys.executable)"}, process);
        if (output < 0) return std::string();
        const auto line = first_line(output);
        close(output);
        waitpid(process, nullptr, 0);
        return line;
    }();
    return program;
}

bool has_loopback() {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
    const bool bound =
        descriptor >= 0 && bind(descriptor, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0;
    if (descriptor >= 0) close(descriptor);
    return bound;
}

bool pictures_are_read() {
    try {
        io::media();
        return true;
    } catch (const Error&) { return false; }
}

}  // namespace

bool can_stand_in() {
    static const bool pictures = pictures_are_read(), loopback = has_loopback();
    if (python().empty()) test::skip_missing("python3 is not there");
    else if (!loopback) test::skip("this machine has no loopback");
    else if (!pictures) test::skip_missing("this build reads no pictures");
    return !python().empty() && loopback && pictures;
}

StandIn& shared_stand_in(const std::string& flavour) {
    static std::map<std::string, std::unique_ptr<StandIn>> running;
    auto& found = running[flavour];
    if (!found) found = std::make_unique<StandIn>(flavour);
    found->reset();
    return *found;
}

StandIn::StandIn(const std::string& flavour, const std::string& host,
                 const std::filesystem::path& certificate, int port)
    : flavour_(flavour), port_(port), host_(host), certificate_(certificate) {
    setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
    start();
}

std::unique_ptr<StandIn> stand_in_at_usual_port(const std::string& flavour) {
    for (const int port : UsualPorts) try {
            return std::make_unique<StandIn>(flavour, "127.0.0.1", std::filesystem::path(), port);
        } catch (const std::runtime_error&) {  // somebody else has it
        }
    test::skip("no usual port of image servers is free");
    return nullptr;
}

void StandIn::start() {
    const auto script = test::source_folder() / "tests/support/stand_in_server.py";
    std::vector<std::string> words{python(), script.string(), "--flavour", flavour_,
                                   "--host", host_,           "--port",    std::to_string(port_)};
    if (!certificate_.empty()) words.insert(words.end(), {"--certificate", certificate_.string()});
    const int output = spawn(words, process_);
    const auto line = output >= 0 ? first_line(output) : std::string();
    if (output >= 0) close(output);
    if (!line.starts_with("port ")) {
        kill();
        throw std::runtime_error("the stand-in does not start");
    }
    port_ = std::stoi(line.substr(5));
}

void StandIn::restart() {
    kill();
    start();
}

StandIn::~StandIn() { kill(); }

void StandIn::kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = -1;
}

std::string StandIn::url() const {
    const bool ipv6 = host_.find(':') != std::string::npos;
    const std::string scheme = certificate_.empty() ? "http://" : "https://";
    return scheme + (ipv6 ? "[" + host_ + "]" : host_) + ":" + std::to_string(port_);
}

nlohmann::json StandIn::control(const std::string& place) {
    HttpClient client(certificate_);
    HttpRequest request;
    request.url = url() + place;
    request.direct = true;
    request.limits.body_bytes = std::size_t{16} << 20;
    const auto result = client.send(request, {});
    if (!result.ok()) throw std::runtime_error("the stand-in does not answer: " + result.detail);
    return parse_json(result.answer.body, "the stand-in's answer");
}

void StandIn::reset(const Knobs& knobs) { control("/gse/reset" + query_of(knobs)); }

void StandIn::set(const Knobs& knobs) { control("/gse/set" + query_of(knobs)); }

nlohmann::json StandIn::log() { return control("/gse/log"); }

std::vector<nlohmann::json> StandIn::asked(const std::string& end) {
    std::vector<nlohmann::json> found;
    for (const auto& entry : log())
        if (entry["path"].get<std::string>().ends_with(end)) found.push_back(entry);
    return found;
}

ServerAddress StandIn::address() const {
    ServerAddress address;
    address.url = url();
    address.times = patient_times();
    return address;
}

ServerTimes patient_times() {
    ServerTimes times;
    times.poll = Milliseconds(10);
    times.slow_poll = Milliseconds(20);
    times.first_retry = Milliseconds(10);
    times.longest_retry = Milliseconds(40);
    times.busy = Milliseconds(200);
    times.away = Milliseconds(2000);
    return times;
}

ServerTimes hasty_times() {
    ServerTimes times = patient_times();
    times.answer = times.drawing = times.silence = Milliseconds(250);
    times.body = Milliseconds(500);
    times.away = Milliseconds(600);
    return times;
}

RedrawOrder small_order(const std::string& prompt) {
    RedrawOrder order;
    order.picture = Image(64, 64, 3);
    order.mask = Image(64, 64, 1);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c)
                order.picture.at(x, y, c) =
                    0.5f + 0.3f * std::sin(0.1f * static_cast<float>(x + y * (c + 1)));
            order.mask.at(x, y, 0) = x >= 16 && x < 48 && y >= 16 && y < 48 ? 1.0f : 0.0f;
        }
    order.prompt = prompt;
    order.seed = 5;
    return order;
}

}  // namespace gse::remote
