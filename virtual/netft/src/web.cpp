#include "web.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <utility>

#include "metier/base/error.hpp"
#include "metier/base/text.hpp"

namespace metier::virtual_netft {

namespace {

namespace http = boost::beast::http;

constexpr std::size_t kLongestShown = 32;

/// A variable of a page that sets.
struct Variable {
    std::string_view page;
    std::string_view name;
    Setting setting;
    int least;
    int most;
    std::size_t gauge = 0;
};

constexpr int kLeastBias = -32768;
constexpr int kMostBias = 32767;
constexpr std::array kVariables{
    Variable{"/comm.cgi", "comrdtrate", Setting::rate, 1, 7000},
    Variable{"/comm.cgi", "commrdtrate", Setting::rate, 1, 7000},  // as some firmware has it
    Variable{"/comm.cgi", "comrdtbsiz", Setting::buffer_size, 1, 40},
    Variable{"/comm.cgi", "comrdte", Setting::rdt_enabled, 0, 1},
    Variable{"/setting.cgi", "setuserfilter", Setting::filter, 0, 12},
    Variable{"/setting.cgi", "setbias0", Setting::gauge_bias, kLeastBias, kMostBias, 0},
    Variable{"/setting.cgi", "setbias1", Setting::gauge_bias, kLeastBias, kMostBias, 1},
    Variable{"/setting.cgi", "setbias2", Setting::gauge_bias, kLeastBias, kMostBias, 2},
    Variable{"/setting.cgi", "setbias3", Setting::gauge_bias, kLeastBias, kMostBias, 3},
    Variable{"/setting.cgi", "setbias4", Setting::gauge_bias, kLeastBias, kMostBias, 4},
    Variable{"/setting.cgi", "setbias5", Setting::gauge_bias, kLeastBias, kMostBias, 5},
};

/// \param header lines besides the usual ones, each with its end
std::string answer(std::string_view status, std::string_view type, std::string_view body,
                   std::string_view header = "") {
    return fmt::format(
        "HTTP/1.0 {}\r\nServer: NetFT\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
        "Connection: close\r\n{}\r\n{}",
        status, type, body.size(), header, body);
}

WebAnswer refusal(std::string_view status, std::string_view why) {
    return {answer(status, "text/plain", fmt::format("{}\n", why))};
}

std::string escaped(std::string_view text) {
    std::string result;
    for (const char character : text) {
        switch (character) {
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '&':
                result += "&amp;";
                break;
            default:
                result += character;
        }
    }
    return result;
}

/// The elements of a page, one a line.
class Elements {
public:
    template <typename Value>
    void add(std::string_view name, const Value& value) {
        text_ += fmt::format("<{}>{}</{}>\n", name, value, name);
    }
    template <typename Value>
    void addAll(std::string_view name, const std::array<Value, 6>& values) {
        add(name, fmt::format("{}", fmt::join(values, ";")));
    }
    void addCounts(std::string_view name, double counts) {
        add(name, fmt::format("{:.0f}", counts));
    }

    std::string within(std::string_view root) const {
        return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<{}>\n{}</{}>\n", root,
                           text_, root);
    }

private:
    std::string text_;
};

/// The largest readings, in the units of the pages.
std::array<std::string, 6> ratings(const Calibration& calibration) {
    std::array<std::string, 6> result;
    for (std::size_t axis = 0; axis < result.size(); ++axis) {
        const auto& unit = axis < 3 ? calibration.force_unit : calibration.torque_unit;
        result[axis] = fmt::format("{:.6g}", calibration.range[axis] / unit.size);
    }
    return result;
}

std::string configurationPage(const WebPages& pages) {
    const auto& calibration = pages.calibration;
    Elements page;
    page.add("prodname", escaped(pages.product));
    page.add("runstat", fmt::format("0x{:08x}", pages.reading.status));
    page.addAll("runft", pages.reading.counts);
    page.add("runrate", kSampleRate);
    page.add("cfgnam", "empty");
    page.add("cfgcalsel", 0);
    page.add("cfgcalsn", kSerialNumber);
    page.add("cfgfu", calibration.force_unit.code);
    page.add("scfgfu", calibration.force_unit.name);
    page.add("cfgtu", calibration.torque_unit.code);
    page.add("scfgtu", calibration.torque_unit.name);
    page.add("cfgtfx", "0;0;0;0;0;0");
    page.add("scfgtdu", "mm");
    page.add("scfgtau", "degrees");
    page.addCounts("cfgcpf", calibration.counts_per_force);
    page.addCounts("cfgcpt", calibration.counts_per_torque);
    page.addAll("cfgmr", ratings(calibration));
    page.add("setcfgsel", 0);
    page.addAll("setbias", pages.gauge_bias);
    page.add("setuserfilter", pages.filter);
    page.add("netip", pages.address);
    page.add("comrdte", pages.rdt_enabled ? "Enabled" : "Disabled");
    page.add("comrdtrate", pages.rate);
    page.add("comrdtbsiz", pages.buffer_size);
    return page.within("netft");
}

std::string calibrationPage(const Calibration& calibration) {
    Elements page;
    page.add("calsn", kSerialNumber);
    page.add("calpn", fmt::format("SI-{:.6g}-{:.6g}", calibration.range[0], calibration.range[5]));
    page.add("calfu", calibration.force_unit.code);
    page.add("scalfu", calibration.force_unit.name);
    page.add("caltu", calibration.torque_unit.code);
    page.add("scaltu", calibration.torque_unit.name);
    page.addCounts("calcpf", calibration.counts_per_force);
    page.addCounts("calcpt", calibration.counts_per_torque);
    page.addAll("calmr", ratings(calibration));
    return page.within("netftCalibration");
}

// ---- what sets ---------------------------------------------------------------------------------

/// \param text "name=value"
Result<Change> parseChange(std::string_view page, std::string_view text) {
    const auto name = text.substr(0, text.find('='));
    const auto* const variable = std::ranges::find_if(kVariables, [&](const Variable& candidate) {
        return candidate.page == page && candidate.name == name;
    });
    if (variable == kVariables.end()) {
        return fail(Errc::invalid_argument, fmt::format("{}: not a variable of {} here",
                                                        name.substr(0, kLongestShown), page));
    }
    const auto value = text.substr(std::min(name.size() + 1, text.size()));
    const auto number = numberIn<int>(value);
    if (!number || *number < variable->least || *number > variable->most) {
        return fail(Errc::out_of_range,
                    fmt::format("{}: '{}' is not within {} to {}", name,
                                value.substr(0, kLongestShown), variable->least, variable->most));
    }
    return Change{variable->setting, *number, variable->gauge};
}

/// \param query "name=value&name=value"
WebAnswer change(std::string_view page, std::string_view query) {
    std::vector<Change> changes;
    while (!query.empty()) {
        const auto text = query.substr(0, query.find('&'));
        const auto parsed = parseChange(page, text);
        if (!parsed) {
            return refusal("400 Bad Request", parsed.error().message);
        }
        changes.push_back(*parsed);
        query.remove_prefix(std::min(text.size() + 1, query.size()));
    }
    if (changes.empty()) {
        return refusal("400 Bad Request", "no variable to set");
    }
    return {answer("302 Found", "text/html", "", "Location: /netftapi2.xml\r\n"),
            std::move(changes)};
}

}  // namespace

WebAnswer answerWeb(std::string_view request, const WebPages& pages) {
    http::request_parser<http::empty_body> parser;
    boost::system::error_code ignored;
    parser.put(boost::asio::buffer(request.data(), request.size()), ignored);
    if (!parser.is_header_done()) {
        return refusal("400 Bad Request", "no HTTP request");
    }
    if (parser.get().method() != http::verb::get) {
        return refusal("405 Method Not Allowed", "GET only");
    }
    const std::string_view target(parser.get().target().data(), parser.get().target().size());
    const auto path = target.substr(0, target.find('?'));
    if (path == "/netftapi2.xml") {
        return {answer("200 OK", "text/xml", configurationPage(pages))};
    }
    if (path == "/netftcalapi.xml") {
        return {answer("200 OK", "text/xml", calibrationPage(pages.calibration))};
    }
    if (std::ranges::find(kVariables, path, &Variable::page) != kVariables.end()) {
        return change(path, target.substr(std::min(path.size() + 1, target.size())));
    }
    return refusal("404 Not Found", "no such page");
}

}  // namespace metier::virtual_netft
