#pragma once
// Going back for whatever lists its state for a checkpoint (base/states/checkpoint.h).

#include "base/states/checkpoint.h"
#include "cosim/core/node.h"

namespace puckloop::cosim {

/// A member of the object that it marks.
template <class Object>
class Marked : public Rewindable {
  public:
    explicit Marked(Object& object) : object_(object) {}
    Marked(const Marked&) = delete;
    Marked& operator=(const Marked&) = delete;

    void mark() override { checkpoint_.take(object_); }
    void rewind() override { checkpoint_.restore(object_); }
    void settle() override {}

  private:
    Object& object_;
    Checkpoint checkpoint_;
};

}  // namespace puckloop::cosim
