// One thread per server, a queue of orders to them, and a queue of news back.
#include "engine/remote/spread/spread_drawing.h"

#include <thread>
#include <utility>

#include "engine/base/shared_queue.h"

namespace gse::remote {
namespace {

/// Word from a server's thread to the one that waits.
struct SpreadWord {
    enum class Kind { Drawn, Preview, Ended } kind;
    std::size_t order = 0;
    Image preview = {};
};

/// Threads of one list of orders. Each order and each server has a place of its own in the outcome: one
/// thread writes it, and it is read when that thread has ended.
class SpreadTeam {
public:
    SpreadTeam(const std::vector<RedrawOrder>& orders, std::size_t servers) : orders_(orders) {
        outcome_.drawn.resize(orders.size());
        outcome_.failures.resize(servers);
        threads_.reserve(servers);
        for (std::size_t i = 0; i < orders.size(); ++i) waiting_.push(i);
    }
    ~SpreadTeam() { end(); }
    SpreadTeam(const SpreadTeam&) = delete;
    SpreadTeam& operator=(const SpreadTeam&) = delete;

    void start(std::size_t index, ImageServer& server, bool previews) {
        threads_.emplace_back([this, index, &server, previews] {
            try {
                draw(index, server, previews);
            } catch (...) {
                outcome_.failures[index] = std::current_exception();
                if (index == 0) end_.request_stop();
            }
            words_.push({SpreadWord::Kind::Ended});
        });
    }
    void request_stop() { end_.request_stop(); }
    /// Hands on what the threads say, until all have ended.
    void listen(const SpreadNews& news) {
        std::size_t done = 0, ended = 0;
        while (ended < outcome_.failures.size()) {
            const auto word = words_.wait({});
            if (word->kind == SpreadWord::Kind::Ended) ++ended;
            if (word->kind == SpreadWord::Kind::Drawn) news.drawn(++done);
            if (word->kind == SpreadWord::Kind::Preview) news.preview(orders_[word->order], word->preview);
        }
    }
    SpreadDrawing take() {
        end();
        return std::move(outcome_);
    }

private:
    void draw(std::size_t index, ImageServer& server, bool previews) {
        while (!end_.stop_requested()) {
            const auto next = waiting_.pop();
            if (!next) return;
            RedrawOrder order = orders_[*next];
            if (previews)
                order.preview = [this, place = *next](const Image& preview) {
                    words_.push({SpreadWord::Kind::Preview, place, preview});
                };
            outcome_.drawn[*next] = {index, server.redraw(order, {{}, end_.get_token()})};
            words_.push({SpreadWord::Kind::Drawn, *next});
        }
    }
    void end() {
        end_.request_stop();
        threads_.clear();  // joins them
    }

    const std::vector<RedrawOrder>& orders_;
    SpreadDrawing outcome_;
    SharedQueue<std::size_t> waiting_;  // orders
    SharedQueue<SpreadWord> words_;
    std::stop_source end_;
    std::vector<std::jthread> threads_;
};

}  // namespace

SpreadDrawing draw_spread(const std::vector<ImageServer*>& servers, const std::vector<RedrawOrder>& orders,
                          const SpreadNews& news, const std::stop_token& stop) {
    SpreadTeam team(orders, servers.size());
    const std::stop_callback stopped(stop, [&] { team.request_stop(); });
    for (std::size_t i = 0; i < servers.size(); ++i)
        team.start(i, *servers[i], i == 0 && news.preview != nullptr);
    team.listen(news);
    return team.take();
}

}  // namespace gse::remote
