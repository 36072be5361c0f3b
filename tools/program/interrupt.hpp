// Ctrl-C as a request: a verb ends soon, keeps what is finished and marks it.
#pragma once

namespace ukemi::tools {

/// From now on SIGINT (Ctrl-C) and SIGTERM are requests; a second one ends the program at once. Called by what asks for
/// them (Run::monitor): a verb that never does is ended by the first, and leaves what stood before.
void catch_interrupts();
/// Whether a request has come.
bool interrupted();

}  // namespace ukemi::tools
