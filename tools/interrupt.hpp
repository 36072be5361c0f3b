// Ctrl-C as a request: a verb ends soon, keeps what is finished and marks it.
#pragma once

namespace ukemi::tools {

/// From now on SIGINT (Ctrl-C) and SIGTERM are requests; a second one ends the program at once.
void catch_interrupts();
/// Whether one has come.
bool interrupted();

}  // namespace ukemi::tools
