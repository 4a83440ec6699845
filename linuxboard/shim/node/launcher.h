#pragma once
// How the program's first process is started under the preloaded library, with the memory that all its
// processes share, its log and its descriptors.

#include "linuxboard/shim/kernel/spec.h"
#include "linuxboard/shim/node/output_log.h"
#include "linuxboard/shim/node/process.h"
#include "linuxboard/shim/wire/wire.h"

#include <memory>
#include <string>

namespace puckloop::linuxboard {

class Launcher {
  public:
    /// Checks the program; starts nothing yet. Throws InputError.
    explicit Launcher(const LinuxSpec& spec);
    ~Launcher();
    Launcher(const Launcher&) = delete;
    Launcher& operator=(const Launcher&) = delete;

    /// Starts the program, which waits in the library until the first reply; its entry is slot 0. Throws
    /// InputError if it cannot be executed, RunError if the host refuses.
    std::unique_ptr<Process> start();

    wire::Page& page() { return *page_; }
    const wire::Page& page() const { return *page_; }
    /// The frames of camera number `camera`, which the program maps: wire::kVideoSize bytes.
    char* video_memory(std::size_t camera);
    OutputLog& log() { return log_; }
    /// What the program wrote to its log since the last call goes to this terminal too.
    void echo_output();
    /// Last line with text that the program wrote to its log, if there is a log file (last_line.h).
    std::string last_line() const;

  private:
    void prepare_page();
    void map_video();

    const LinuxSpec& spec_;
    std::string file_;
    std::string shim_;
    wire::Page* page_ = nullptr;
    char* video_ = nullptr;  // of all cameras
    int page_fd_ = -1;
    OutputLog log_;
    off_t echoed_ = 0;
};

}  // namespace puckloop::linuxboard
