#pragma once
// Two stream sockets, each of which is sent what comes from the other. The end of what one sends is passed on
// as such (half-close); a failure closes both. What waits in one direction is bounded: a side that does not
// read holds up the other one.

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/write.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <utility>

namespace puckloop {

/// Lives in a shared_ptr: as long as octets may come.
template <class First, class Second>
class OctetRelay : public std::enable_shared_from_this<OctetRelay<First, Second>> {
  public:
    OctetRelay(First first, Second second) : first_(std::move(first)), second_(std::move(second)) {}

    First& first() { return first_; }
    Second& second() { return second_; }

    /// Both are connected.
    void begin() {
        pass(first_, second_, there_);
        pass(second_, first_, back_);
    }

  private:
    using Error = boost::system::error_code;
    static constexpr std::size_t kBlock = 16 * 1024;
    using Block = std::array<char, kBlock>;

    template <class From, class To>
    void pass(From& from, To& to, Block& block) {
        auto self = this->shared_from_this();
        from.async_read_some(
            boost::asio::buffer(block), [self, &from, &to, &block](const Error& error, std::size_t size) {
                if (error) return self->ended(to, error);
                boost::asio::async_write(to, boost::asio::buffer(block, size),
                                         [self, &from, &to, &block](const Error& failed, std::size_t) {
                                             if (failed) return self->close();
                                             self->pass(from, to, block);
                                         });
            });
    }
    template <class To>
    void ended(To& to, const Error& error) {
        if (error != boost::asio::error::eof) return close();
        Error ignored;
        to.shutdown(To::shutdown_send, ignored);
    }
    void close() {
        Error ignored;
        first_.close(ignored);
        second_.close(ignored);
    }

    First first_;
    Second second_;
    Block there_{}, back_{};
};

}  // namespace puckloop
