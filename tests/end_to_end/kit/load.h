#pragma once
// Work that competes for the processors while a run goes on.

#include <sys/types.h>

#include <vector>

namespace puckloop::tests {

/// So many niced processes that compute until the object goes (or half a minute has passed).
class Load {
  public:
    explicit Load(int processes);
    ~Load();
    Load(const Load&) = delete;
    Load& operator=(const Load&) = delete;

  private:
    std::vector<pid_t> burners_;
};

}  // namespace puckloop::tests
