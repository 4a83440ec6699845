#include "ends/script_end.h"

#include "base/error.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <catch2/catch.hpp>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

using namespace puckloop;
using exec::UartEnd;

namespace {

/// Polls until the end has `count` bytes or two seconds are over.
std::string take_from(UartEnd& end, std::size_t count) {
    std::string got;
    for (int i = 0; i < 400 && got.size() < count; ++i) {
        end.poll(i, cosim::kNever);
        while (end.next() != cosim::kNever)
            got += static_cast<char>(end.take());
        if (got.size() < count) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return got;
}

std::uint16_t port_of(const UartEnd& end) {
    const std::string text = end.announcement();
    return static_cast<std::uint16_t>(std::stoi(text.substr(text.rfind(':') + 1)));
}

}  // namespace

TEST_CASE("a script end sends its lines in order and keeps what it hears") {
    exec::ScriptEnd end(exec::parse_uart_script("u", "1 0102\n2 03"));
    CHECK(end.next() == cosim::kSecond);
    CHECK(end.take() == 1);
    CHECK(end.next() == cosim::kSecond);
    CHECK(end.take() == 2);
    CHECK(end.next() == 2 * cosim::kSecond);
    CHECK(end.take() == 3);
    CHECK(end.next() == cosim::kNever);
    end.receive(9, true, 77);
    REQUIRE(end.received().size() == 1);
    CHECK(end.received()[0].byte == 9);
    CHECK(end.received()[0].start == 77);
    CHECK_FALSE(end.live());
}

TEST_CASE("a TCP end carries bytes both ways, takes one client, and survives its leaving") {
    using boost::asio::ip::tcp;
    const auto end = exec::make_tcp_end(0);
    CHECK(end->live());
    boost::asio::io_context io;
    const tcp::endpoint there(boost::asio::ip::address_v4::loopback(), port_of(*end));
    end->receive('x', true, 0);  // nobody there: dropped
    {
        tcp::socket client(io);
        client.connect(there);
        boost::asio::write(client, boost::asio::buffer("V\r", 2));
        CHECK(take_from(*end, 2) == "V\r");
        for (const char c : std::string("v,1"))
            end->receive(static_cast<std::uint8_t>(c), true, 0);
        end->poll(0, cosim::kNever);
        char got[3];
        boost::asio::read(client, boost::asio::buffer(got));
        CHECK(std::string(got, 3) == "v,1");
        tcp::socket second(io);
        second.connect(there);
        end->poll(0, cosim::kNever);
        boost::system::error_code error;
        CHECK(second.read_some(boost::asio::buffer(got), error) == 0);  // hung up on
        CHECK(error);
    }
    for (int i = 0; i < 20; ++i)
        end->poll(0, cosim::kNever);
    tcp::socket next(io);
    next.connect(there);
    boost::asio::write(next, boost::asio::buffer("again", 5));
    CHECK(take_from(*end, 5) == "again");
}

TEST_CASE("a TCP client that has sent all it has still gets what the board answers, and makes room") {
    using boost::asio::ip::tcp;
    const auto end = exec::make_tcp_end(0);
    boost::asio::io_context io;
    const tcp::endpoint there(boost::asio::ip::address_v4::loopback(), port_of(*end));
    tcp::socket client(io);
    client.connect(there);
    boost::asio::write(client, boost::asio::buffer("V\r", 2));
    client.shutdown(tcp::socket::shutdown_send);  // as `printf 'V\r' | nc 127.0.0.1 PORT`
    CHECK(take_from(*end, 2) == "V\r");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // its end is noticed
    for (const char c : std::string("v,1"))
        end->receive(static_cast<std::uint8_t>(c), true, 0);
    end->poll(0, cosim::kNever);
    char got[3];
    boost::system::error_code error;
    CHECK(boost::asio::read(client, boost::asio::buffer(got), error) == 3);
    CHECK(std::string(got, 3) == "v,1");
    tcp::socket next(io);
    next.connect(there);
    boost::asio::write(next, boost::asio::buffer("again", 5));
    CHECK(take_from(*end, 5) == "again");
}

TEST_CASE("a TCP port that is taken is an input error of one line") {
    const auto first = exec::make_tcp_end(0);
    try {
        exec::make_tcp_end(port_of(*first));
        FAIL("a second listener was let in");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()).find("uart: tcp:") == 0);
    }
}

TEST_CASE("a pty end is a raw terminal") {
    if (access("/dev/pts", R_OK) != 0 || std::filesystem::is_empty("/dev/pts")) {
        WARN("no devpts at /dev/pts (a bare chroot?): skipped");
        return;
    }
    const auto end = exec::make_pty_end();
    const std::string text = end->announcement();
    REQUIRE(text.starts_with("pty /dev/"));
    const int terminal = open(text.substr(4).c_str(), O_RDWR | O_NOCTTY);
    REQUIRE(terminal >= 0);
    REQUIRE(write(terminal, "\x01\x03\r\n\0", 5) == 5);
    CHECK(take_from(*end, 5) == std::string("\x01\x03\r\n\0", 5));
    for (const char byte : std::string("\x0C\x0A\x04"))
        end->receive(static_cast<std::uint8_t>(byte), true, 0);
    end->poll(0, cosim::kNever);
    std::string got;
    char byte;
    for (pollfd waiting{terminal, POLLIN, 0}; got.size() < 3 && poll(&waiting, 1, 2000) == 1;)
        if (read(terminal, &byte, 1) == 1) got += byte;
    CHECK(got == "\x0C\x0A\x04");
    close(terminal);
}
