#pragma once
// trace.csv: written during a run, read by `puckloop trace`, any spreadsheet or script.

#include "cosim/trace/trace.h"
#include "cosim/trace/trace_row.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <istream>
#include <string>
#include <utility>

namespace puckloop::cosim {

/// Writes the messages that their links ask to be recorded. A failed write (full disk) throws RunError once;
/// what was written stays, and nothing more is tried.
class TraceCsvSink : public TraceSink {
  public:
    enum class Rows : std::uint8_t { Wanted, All };
    /// Creates or replaces the file; throws RunError. `All`: also of links that do not ask to be recorded.
    explicit TraceCsvSink(const std::string& path, Rows rows = Rows::Wanted);
    ~TraceCsvSink() override;
    TraceCsvSink(const TraceCsvSink&) = delete;
    TraceCsvSink& operator=(const TraceCsvSink&) = delete;

    /// `text` takes the place of the line of column names: what the file of a run held from which this one
    /// goes on. Before begin().
    void begin_with(std::string text) { begin_with_ = std::move(text); }
    /// What the file holds so far. Throws RunError.
    std::string written();
    /// How many bytes that is. Throws RunError.
    std::uint64_t size();
    /// The file holds so many bytes again, and begin() adds nothing to them. Throws RunError.
    void cut_back(std::uint64_t size);

    void begin(const std::vector<LinkSpec>& links) override;
    void record(const TraceRecord& record) override;
    void flush() override;

  private:
    void put(const std::string& line);
    [[noreturn]] void fail();

    std::string path_;
    Rows rows_;
    std::FILE* file_ = nullptr;
    bool failed_ = false;
    bool goes_on_ = false;  ///< begin() finds what the file is to begin with
    /// What is the same in all that one end of a link sends.
    struct Sender {
        std::string columns;
        bool wanted = true;
        std::vector<std::string> signals;
    };
    std::vector<Sender> senders_;  // by link, from a and from b
    std::string line_;             // scratch
    std::string begin_with_;
};

/// What a record holds, with names for numbers.
TraceRow to_row(const TraceRecord& record, const std::vector<LinkSpec>& links);

/// Calls `take` for each row, in the order of the file. Throws InputError naming `name` and the line. A last
/// line without its end (the writer was killed) is left out; then the result is false.
bool read_trace(std::istream& in, const std::string& name, const std::function<void(const TraceRow&)>& take);

}  // namespace puckloop::cosim
