#pragma once

#include "metier/http/httplib.hpp"

#include <string>

#include "metier/base/error.hpp"

namespace metier::dashboard {

// Checks of a request before it is handled. Threads: any; pure.

/// Refuses a request that another page may have made a browser send: the Host must be an address or
/// `localhost`, so that no foreign name was pointed at this machine, and the Origin, if there is
/// one, must be this page.
/// \param host_name another name of this page; empty: none
/// Errors: access_denied, saying what is wrong.
Result<void> checkOrigin(const httplib::Request& request, const std::string& host_name);

/// Whether it is an address of this machine that no other machine reaches: 127.0.0.0/8, ::1,
/// "localhost".
bool isLoopback(const std::string& address);

/// Whether a request comes from this machine, and not through a proxy that passes on others'.
/// Errors: access_denied.
Result<void> checkLocal(const httplib::Request& request);

/// Whether a request that changes something says that it comes from the page's own program: header
/// `X-Metier: 1`, which no other page can make a browser send, and a body of JSON.
/// Errors: access_denied; invalid_argument.
Result<void> checkIntent(const httplib::Request& request);

/// Name of the cookie with the log-in: `metier_` and the port in the request's Host, since browsers
/// send the cookies of all ports of a host to each of them; `metier` if the Host has no port.
std::string sessionCookieName(const httplib::Request& request);

/// The value of a cookie; empty if there is none.
std::string cookie(const httplib::Request& request, const std::string& name);

/// Headers that every answer has: what the page may load and who may show it.
httplib::Headers protectiveHeaders();

}  // namespace metier::dashboard
