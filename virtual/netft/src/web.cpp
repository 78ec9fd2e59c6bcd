#include "metier/virtual_netft/web.hpp"

#include <fmt/format.h>

namespace metier::virtual_netft {

namespace {

std::string answer(std::string_view status, std::string_view type, std::string_view body) {
    return fmt::format(
        "HTTP/1.0 {}\r\nServer: NetFT\r\nContent-Type: {}\r\nContent-Length: {}\r\n"
        "Connection: close\r\n\r\n{}",
        status, type, body.size(), body);
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

std::string configuration(std::string_view product, const Calibration& calibration) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<netft>\n<prodname>{}</prodname>\n"
        "<scfgfu>{}</scfgfu>\n<scfgtu>{}</scfgtu>\n<cfgcpf>{:.0f}</cfgcpf>\n"
        "<cfgcpt>{:.0f}</cfgcpt>\n</netft>\n",
        escaped(product), calibration.force_unit.name, calibration.torque_unit.name,
        calibration.counts_per_force, calibration.counts_per_torque);
}

std::string calibrationPage(const Calibration& calibration) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<netftCalibration>\n<calcpf>{:.0f}</calcpf>\n"
        "<calcpt>{:.0f}</calcpt>\n</netftCalibration>\n",
        calibration.counts_per_force, calibration.counts_per_torque);
}

}  // namespace

std::string answerWeb(std::string_view request, std::string_view product,
                      const Calibration& calibration) {
    const auto line = request.substr(0, request.find("\r\n"));
    const auto method = line.substr(0, line.find(' '));
    if (method.size() == line.size()) {
        return answer("400 Bad Request", "text/plain", "no HTTP request\n");
    }
    if (method != "GET") {
        return answer("405 Method Not Allowed", "text/plain", "GET only\n");
    }
    const auto rest = line.substr(method.size() + 1);
    const auto path = rest.substr(0, rest.find_first_of(" ?"));
    if (path == "/netftapi2.xml") {
        return answer("200 OK", "text/xml", configuration(product, calibration));
    }
    if (path == "/netftcalapi.xml") {
        return answer("200 OK", "text/xml", calibrationPage(calibration));
    }
    return answer("404 Not Found", "text/plain", "no such page\n");
}

}  // namespace metier::virtual_netft
