#pragma once

#include "metier/metrics/text_page.hpp"

namespace metier::metrics {

/// Adds what the kernel knows of this process, by the names that Prometheus has for it: CPU time,
/// memory, open files, start. Threads: any.
void addProcess(TextPage& page);

}  // namespace metier::metrics
