// What becomes of the trace: put in order, counted and written, by this thread or beside it.

#include "cosim/conductor_state.h"

#include <exception>
#include <utility>

namespace puckloop::cosim {

/// Everything before `floor`. Nothing may be written beside.
void Conductor::State::release_trace(Time floor) {
    current_ = kNobody;
    if (trace_ended_) return;
    merger_.take(floor, batch_);
    write_trace();
    take_written();
}

/// The same by a helper, if there is one, unless what it was given before is not written yet.
void Conductor::State::release_trace_beside(Time floor) {
    if (writing_) return;
    if (workers_->helpers() == 0 || workers_->resting()) return release_trace(floor);
    merger_.take(floor, batch_);
    writing_ = true;
    workers_->submit(trace_piece(), true);
}

/// What is left of batch_, on any thread.
void Conductor::State::write_trace() {
    try {
        if (written_ == 0) TraceMerger::sort(batch_);
        for (; written_ < batch_.size(); ++written_) {
            const TraceRecord& record = batch_[written_];
            stats_[record.link * 2u + static_cast<unsigned>(record.direction)].count(
                record, links_[record.link].nominal_baud);
            for (TraceSink* sink : sinks)
                sink->record(record);
        }
    } catch (...) {
        trace_failure_ = std::current_exception();
    }
}

/// No other thread writes any more; what was left is written here.
void Conductor::State::take_written() {
    current_ = kNobody;
    writing_ = false;
    if (!trace_failure_) write_trace();
    batch_.clear();
    written_ = 0;
    if (!trace_failure_) return;
    trace_ended_ = true;
    std::rethrow_exception(std::exchange(trace_failure_, nullptr));
}

void Conductor::State::finish_trace() {
    while (writing_) {
        if (!workers_->do_one()) workers_->wait();
        done_.clear();
        take_done();
        for (const std::size_t n : done_)
            take_local_reply(n);
    }
}

}  // namespace puckloop::cosim
