"""`python -m ikde` and the `ikde` command."""


def main() -> None:
    """Run the command line; Ctrl-C while it is still being imported is Ctrl-C as well."""
    try:
        from ikde.cli.app import run_and_exit
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    run_and_exit()


if __name__ == "__main__":
    main()
