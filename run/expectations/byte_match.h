#pragma once
// A text in bytes that come one by one.

#include <string>
#include <utility>

namespace puckloop::tools {

class ByteMatch {
  public:
    ByteMatch() = default;
    explicit ByteMatch(std::string text) : text_(std::move(text)) {}
    bool has_text() const { return !text_.empty(); }
    /// The text ends with this byte.
    bool add(char byte) {
        last_ += byte;
        if (last_.size() > text_.size()) last_.erase(0, 1);
        return last_ == text_;
    }

  private:
    std::string text_, last_;  // `last_`: as many bytes as the text has, at most
};

}  // namespace puckloop::tools
