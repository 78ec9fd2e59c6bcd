// Boost.Asio and the standalone Asio of link cannot be included in one file.
#include "http_get.hpp"

#include <fmt/format.h>

#include <boost/asio/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <optional>
#include <utility>

namespace metier::netft_driver {
namespace {

namespace http = boost::beast::http;
using boost::system::error_code;

/// Bytes as Beast reads them, and why there are no more.
struct Stream {
    const ReceiveSome& receive;
    std::optional<Error> failure{};

    template <typename Buffers>
    std::size_t read_some(const Buffers& buffers, error_code& error) {  // NOLINT: Beast's name
        const boost::asio::mutable_buffer buffer = *boost::asio::buffer_sequence_begin(buffers);
        const auto count = receive({static_cast<std::byte*>(buffer.data()), buffer.size()});
        if (!count && count.error().code != Errc::connection_lost) {
            failure = count.error();
        }
        error = count ? error_code() : error_code(boost::asio::error::eof);
        return count.value_or(0);
    }
    template <typename Buffers>
    std::size_t read_some(const Buffers& buffers);  // NOLINT: Beast asks for it and calls it never
};

Error errorOf(error_code error, const http::response_parser<http::string_body>& answer) {
    if (error == http::error::body_limit || error == http::error::header_limit) {
        return {Errc::invalid_argument, fmt::format("over {} bytes", kLargestPage)};
    }
    if (error == http::error::partial_message && answer.is_header_done()) {
        return {Errc::invalid_argument,
                fmt::format("{} of {} bytes came", answer.get().body().size(),
                            answer.content_length().value_or(0))};
    }
    return {Errc::invalid_argument, fmt::format("no HTTP answer: {}", error.message())};
}

}  // namespace

Result<std::string> readHttpAnswer(const ReceiveSome& receive) {
    Stream stream{receive};
    boost::beast::flat_buffer buffer(kLargestPage);
    http::response_parser<http::string_body> answer;
    answer.body_limit(kLargestPage);
    error_code error;
    http::read_header(stream, buffer, answer, error);
    if (!error && answer.get().result_int() != 200) {
        return fail(Errc::not_found, fmt::format("HTTP status {}", answer.get().result_int()));
    }
    if (!error) {
        http::read(stream, buffer, answer, error);
    }
    if (error) {
        return fail(stream.failure.value_or(errorOf(error, answer)));
    }
    return std::move(answer.get().body());
}

}  // namespace metier::netft_driver
