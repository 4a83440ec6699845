#pragma once
// /proc/NUMBER: numbers of processes in paths are the program's own, as everywhere (process_numbers.h).

namespace puckloop::shim {

/// `path` as the host has it: of a process of the program its number there; of any other none that is there.
/// What is no such path, and what is no text, stays.
class ProcessPath {
  public:
    explicit ProcessPath(const char* path);
    /// The same for a path that begins at the open folder `folder`, which may be /proc.
    ProcessPath(int folder, const char* path);
    ProcessPath(const ProcessPath&) = delete;
    ProcessPath& operator=(const ProcessPath&) = delete;
    operator const char*() const { return path_; }

  private:
    void translate(const char* path);

    const char* path_;
    char room_[512];  ///< a handler calls on a small stack; longer paths there are none below /proc
};

}  // namespace puckloop::shim
