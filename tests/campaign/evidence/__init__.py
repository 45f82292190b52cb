"""What campaigns came to: `python -m tests.campaign.evidence`, and `.thousand`."""
