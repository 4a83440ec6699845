#pragma once
// A recorded trace on disk, read row by row and as often as needed, and which of its rows are wanted.

#include "cosim/trace/trace_row.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

/// Which rows; an empty list is all. Times in seconds, the end not included.
struct TraceSelection {
    std::vector<std::string> links, nodes, kinds;
    double from_s = 0.0;
    double until_s = 9e6;
    /// `nodes` must occur, but whatever the others sent is wanted too.
    bool nodes_only_named = false;
    /// Signals by name whose rows are left out unread, which costs a fraction of reading them; what is wrong
    /// in such a row is not found. Empty: none.
    std::function<bool(std::string_view)> passes_over{};
    /// An incomplete last line is worth a warning: not while the file grows.
    bool warns = true;

    bool wanted(const cosim::TraceRow& row) const;
};

/// "uart", "i2c", "signal", "radio", "can" or "packet".
std::string_view kind_of(const cosim::TraceRow& row);

class RecordedTrace {
  public:
    /// `place` is a trace.csv or the results folder that has one. Throws InputError: no such file, nothing
    /// that can be read twice, another format.
    RecordedTrace(const std::filesystem::path& place, TraceSelection selection);
    /// The same rows under another selection.
    RecordedTrace with(TraceSelection selection) const;

    const std::filesystem::path& file() const { return file_; }
    const TraceSelection& selection() const { return selection_; }

    /// Rows in the order of the file, wanted ones only. Of a file that grows each of them reads what was
    /// there when the trace was made: who reads it twice finds nothing in the second reading that the first
    /// one did not see.
    class Cursor {
      public:
        explicit Cursor(const RecordedTrace& trace);
        /// Nothing at the end. Throws InputError naming file and line.
        std::optional<cosim::TraceRow> next();
        /// The next row, wanted or not.
        std::optional<cosim::TraceRow> next_of_all();
        /// False once the end was reached in the middle of a line: its writer was killed.
        bool whole() const { return whole_; }

      private:
        /// False at the end of the file. Throws InputError for a line that nobody writes.
        bool read_line();
        bool is_passed_over() const;
        [[noreturn]] void refuse_long() const;

        const RecordedTrace& trace_;
        std::ifstream in_;
        std::uintmax_t left_;  ///< bytes that may still be read of it
        std::vector<char> buffer_;
        std::size_t begin_ = 0, end_ = 0;  ///< of what is read and not taken yet
        std::string_view line_;
        bool line_ended_ = true;
        std::size_t number_ = 0;
        bool whole_ = true;
    };

    /// Reads everything once. Checks that the links and nodes asked for occur (throws InputError naming the
    /// option) and warns on standard error of an incomplete last line.
    void for_each_checked(const std::function<void(const cosim::TraceRow&)>& take) const;

  private:
    std::filesystem::path file_;
    TraceSelection selection_;
    std::uintmax_t size_ = 0;  // bytes of it that count
};

/// Throws InputError if no file can be written at `path` ("-" always can): known before the work is done.
void check_output_file(const std::string& path);

/// Calls `write` with the open file, "-" being the standard output. Throws RunError when it cannot be
/// written; what was written of it then goes, whatever `write` throws.
void write_output(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace puckloop::tools
