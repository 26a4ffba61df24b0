"""A window whose dialogs are opened one after the other, to be read."""


def dialogs(driver):
    """The settings, and the dialogs of studies."""
    window = driver.window
    window.settings_page.open()
    show(driver, "settings", window.settings_page.dialog)
    runs = window.runs
    openers = (
        *(runs.open_sweep, runs.open_animation, runs.open_press, runs.open_paper),
        runs.open_verification,
    )
    for name, open_dialog in zip(("sweep", "animate", "press", "paper", "verify"), openers, strict=True):
        open_dialog()
        show(driver, name, runs.dialogs[name])
    window.reports.open_volumes()
    show(driver, "volumes", window.reports.volumes)
    window.case_studies.design_study()
    for row in window.case_studies.dialog.varied.rows.values():
        row.check.setChecked(True)
    show(driver, "study", window.case_studies.dialog)
    window.help.toggle_sheet()
    driver.scene("shortcuts")
    window.help.close()


def show(driver, name, dialog):
    dialog.move(60, 30)
    driver.scene(name)
    dialog.close()
    driver.wait()
