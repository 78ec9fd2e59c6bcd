#pragma once

#include "metrics/text_page.hpp"

namespace metier::server {

/// Adds what the kernel knows of this process, by the names that Prometheus has for it: CPU time,
/// memory, open files, start. Threads: any.
void addProcess(TextPage& page);

}  // namespace metier::server
