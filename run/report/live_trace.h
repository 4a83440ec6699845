#pragma once
// The trace as pcapng while the run goes on: into a named pipe that Wireshark reads, the standard output, or
// a file. The run waits for a slow reader; one that goes away ends the stream, not the run.

#include "cosim/trace/trace.h"
#include "traces/formats/pcapng_stream.h"

#include <csignal>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace puckloop::tools {

class LiveTrace : public cosim::TraceSink {
  public:
    /// "-" is the standard output. Opens the file; waits for the reader of a named pipe. `interrupted`, if
    /// not null, ends every wait once it is set. Throws InputError for what cannot be written, RunError when
    /// interrupted.
    LiveTrace(const std::string& path, const volatile std::sig_atomic_t* interrupted);
    ~LiveTrace() override;
    LiveTrace(const LiveTrace&) = delete;
    LiveTrace& operator=(const LiveTrace&) = delete;

    void begin(const std::vector<cosim::LinkSpec>& links) override;
    /// Of the rows that trace.csv has.
    void record(const cosim::TraceRecord& record) override;
    void flush() override;
    /// The run is over: the rest of it.
    void end();

  private:
    class Pipe;
    std::unique_ptr<Pipe> pipe_;
    std::unique_ptr<std::ostream> out_;
    std::unique_ptr<PcapngStream> stream_;
    std::vector<cosim::LinkSpec> links_;
};

}  // namespace puckloop::tools
