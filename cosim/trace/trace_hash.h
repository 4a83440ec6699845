#pragma once
// The trace's fingerprint: SHA-256 over a canonical binary form of every message, faults included.

#include "cosim/core/codec.h"
#include "cosim/trace/trace.h"

#include <nettle/sha2.h>

#include <string>

namespace puckloop::cosim {

/// The form: a head naming links, ends and ports (of those with LinkSpec::hashed_when_unused), then for each
/// message delivery time, link, direction, fault and payload as cosim/core/codec.h writes them.
class TraceHash : public TraceSink {
  public:
    TraceHash();
    void begin(const std::vector<LinkSpec>& links) override;
    void record(const TraceRecord& record) override;

    /// 64 hex digits. Ends the hash; call once.
    std::string finish();

    /// The hash so far, begin() included, for a snapshot of the run; loaded after begin() with the same
    /// links.
    std::vector<std::uint8_t> save();
    /// Throws StateError.
    void load(const std::vector<std::uint8_t>& saved);

  private:
    void drain();

    sha256_ctx context_;
    Bytes buffer_;
};

}  // namespace puckloop::cosim
