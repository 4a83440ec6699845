#include "cosim/remote/mpi/rank_server.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/core/wall_clock.h"
#include "cosim/remote/mpi/patience.h"
#include "cosim/remote/node_session.h"

#include <sys/resource.h>

#include <exception>
#include <map>
#include <memory>
#include <vector>

namespace puckloop::cosim {

namespace {

/// Of programs that have ended.
double programs_s() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto seconds = [](const timeval& time) {
        constexpr double kMicrosecond = 1e-6;
        return static_cast<double>(time.tv_sec) + kMicrosecond * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class RankServer {
  public:
    explicit RankServer(const NodeFactory& factory) : factory_(factory) {}

    void serve() {
        Patience patience;
        Bytes bytes;
        while (true) {
            // Only who waits for a program sees that it has ended.
            bool any = go_on_with_waiting(patience.used_up());
            if (const auto origin = take_message(bytes)) {
                any = true;
                if (origin->tag == kEndTag) return echo_.send(0, kEndTag, {});
                answer(origin->tag, bytes);
            }
            any ? patience.renew() : patience.wait();
        }
    }

  private:
    struct Served {
        explicit Served(const NodeFactory& factory) : session(factory, [](const std::string&) {}) {}

        NodeSession session;
        Outgoing answer;
    };

    void answer(int tag, Bytes& bytes) {
        if (tag >= kFirstNodeTag) return take(tag, bytes);
        if (tag == kWorkTag) {
            bytes.clear();
            ByteWriter(bytes).f64(worked_s_ + programs_s());
        }
        echo_.send(0, tag, bytes);
    }

    void take(int tag, const Bytes& bytes) {
        std::unique_ptr<Served>& served = served_[tag];
        if (!served) served = std::make_unique<Served>(factory_);
        guarded(tag, *served,
                [&] { return served->session.take(std::span(bytes).subspan(protocol::kLengthBytes)); });
    }

    /// True if one of those that wait for their programs has got on. `wait`: lets each wait for some
    /// milliseconds.
    bool go_on_with_waiting(bool wait) {
        const std::vector<int> tags = std::exchange(waiting_, {});
        for (const int tag : tags)
            guarded(tag, *served_.at(tag), [&] { return served_.at(tag)->session.resume(wait); });
        return waiting_.size() < tags.size();
    }

    template <class Work>
    void guarded(int tag, Served& served, Work work) {
        const auto begun = WallClock::now();
        try {
            const bool done = work();
            worked_s_ += seconds_since(begun);
            if (!done) return waiting_.push_back(tag);
            served.answer.send(0, tag, served.session.answer());
        } catch (const InputError& error) {
            served.answer.send(0, tag, served.session.failure(true, error.what()));
        } catch (const std::exception& error) {
            served.answer.send(0, tag, served.session.failure(false, reason_of(error)));
        }
    }

    const NodeFactory& factory_;
    std::map<int, std::unique_ptr<Served>> served_;  ///< by tag
    std::vector<int> waiting_;                       ///< for their programs
    Outgoing echo_;
    double worked_s_ = 0;  ///< wall time
};

}  // namespace

void serve_rank(const NodeFactory& factory) {
    RankServer(factory).serve();
}

}  // namespace puckloop::cosim
